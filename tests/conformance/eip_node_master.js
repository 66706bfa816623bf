// npm st-ethernet-ip as a master: a request a line on standard input, its outcome a line on standard output.
// Usage: eip_node_master.js LOCAL_ADDRESS      the scanner binds UDP 2222 there
//
//   explicit NAME HOST plain|routed|class3     connects; routed: each request in an Unconnected_Send; class3: Forward_Open
//   request NAME SERVICE CLASS INSTANCE ATTRIBUTE|- [HEX]      -> status data (hex)
//   io NAME HOST OUTPUT SIZE INPUT SIZE RPI_MS   an exclusive owner; tries until it gets the connection
//   out NAME HEX    in NAME -> packets data      silent NAME      close NAME (Forward_Close)      drop NAME (TCP only)
"use strict";
const readline = require("readline");
const {Controller, EthernetIP, IO} = require("st-ethernet-ip");
const {CIP, ENIP} = EthernetIP;
const {LOGICAL} = CIP.EPATH.segments;

const local = process.argv[2];
const PATIENCE_MS = 15000;
const NO_ROUTE = Buffer.alloc(0);  // to the device itself
const explicits = new Map(), connections = new Map();
let scanner;

async function openExplicit(name, host, kind) {
  const master = kind === "plain" ? new ENIP() : new Controller(kind === "class3");
  if (kind === "plain") await master.connect(host, PATIENCE_MS, local);
  else await master.connect(host, NO_ROUTE, false);
  explicits.set(name, {master, connected: kind === "class3"});
  return [];
}

function request(name, service, classId, instance, attribute, hex) {
  const {master, connected} = explicits.get(name);
  const path = [LOGICAL.build(LOGICAL.types.ClassID, Number(classId)),
                LOGICAL.build(LOGICAL.types.InstanceID, Number(instance))];
  if (attribute !== "-") path.push(LOGICAL.build(LOGICAL.types.AttributeID, Number(attribute)));
  const message = CIP.MessageRouter.build(Number(service), Buffer.concat(path), Buffer.from(hex || "", "hex"));
  const event = connected ? "SendUnitData Received" : "SendRRData Received";
  return new Promise((resolve, reject) => {
    const timer = setTimeout(() => reject(new Error("no answer")), PATIENCE_MS);
    master.once(event, (items) => {
      clearTimeout(timer);
      const data = connected ? items[1].data.subarray(2) : items[1].data;
      const answer = CIP.MessageRouter.parse(data);
      if (answer.service !== (Number(service) | 0x80)) return reject(new Error(`service ${answer.service}`));
      resolve([answer.generalStatusCode, answer.data.toString("hex")]);
    });
    master.write_cip(message, connected);
  });
}

function openIo(name, host, output, outputSize, input, inputSize, rpi) {
  if (!scanner) scanner = new IO.Scanner(2222, local);
  connections.set(name, scanner.addConnection({
    configInstance: {assembly: 1, size: 0},
    outputInstance: {assembly: Number(output), size: Number(outputSize)},
    inputInstance: {assembly: Number(input), size: Number(inputSize)},
  }, Number(rpi), host, 2222));
  return [];
}

const verbs = {
  explicit: openExplicit,
  request,
  io: openIo,
  out(name, hex) { connections.get(name).outputData = Buffer.from(hex, "hex"); return []; },
  in(name) {
    const c = connections.get(name);
    return [c.TOsequenceNum, c.inputData.toString("hex")];
  },
  silent(name) { connections.get(name).run = false; return []; },
  async close(name) {
    const c = connections.get(name);
    c.run = false;
    await c.tcpController.disconnect();
    return [];
  },
  drop(name) {
    (explicits.get(name)?.master ?? connections.get(name).tcpController).end();
    return [];
  },
};

async function main() {
  for await (const line of readline.createInterface({input: process.stdin})) {
    const [verb, ...words] = line.split(" ");
    try {
      console.log(["ok", ...(await verbs[verb](...words))].join(" "));
    } catch (error) {
      console.log(`error ${verb}: ${error.message ?? JSON.stringify(error)}`);
    }
  }
  process.exit(0);
}

main().catch((error) => {
  console.log(`error ${error.message}`);
  process.exit(1);
});
