// npm modbus-serial as a master: a request a line on standard input, its outcome a line on standard output.
// Usage: node_master.js tcp|rtu HOST PORT UNIT TIMEOUT_MS      rtu: raw RTU frames over the connection
"use strict";
const readline = require("readline");
const ModbusRTU = require("modbus-serial");

const [kind, host, port, unit, timeout] = process.argv.slice(2);
const client = new ModbusRTU();

async function ask(words) {
  const [verb, address, value] = [words[0], Number(words[1]), Number(words[2])];
  if (verb === "write") {
    const echo = await client.writeRegister(address, value);
    if (echo.address !== address || echo.value !== value) throw new Error("wrong echo");
    return [];
  }
  const call = verb === "read" ? client.readHoldingRegisters : client.readInputRegisters;
  return (await call.call(client, address, value)).data;
}

function outcome(error) {
  if (error.modbusCode !== undefined) return `exception ${error.modbusCode}`;
  return error.errno === "ETIMEDOUT" ? "silence" : `error ${error.message}`;
}

async function main() {
  const options = {port: Number(port)};
  await (kind === "tcp" ? client.connectTCP(host, options) : client.connectTelnet(host, options));
  client.setID(Number(unit));
  client.setTimeout(Number(timeout));
  for await (const line of readline.createInterface({input: process.stdin})) {
    try {
      console.log(["ok", ...(await ask(line.split(" ")))].join(" "));
    } catch (error) {
      console.log(outcome(error));
    }
  }
  process.exit(0);
}

main().catch((error) => {
  console.log(`error ${error.message}`);
  process.exit(1);
});
