// npm canopen as a master: finds a node by its boot-up, configures and runs it by SDO and PDO, sees the trip as an
// emergency, resets it. Ends with status 0 if all of it happened. Usage: canopen_node_master.js HOST PORT NODE
"use strict";
const assert = require("assert");
const net = require("net");

// canopen needs its native CRC for block transfers only, which this board refuses: it is not built.
require.cache[require.resolve("node-crc")] = {exports: {crc() { throw new Error("no block transfers"); }}};
const {Device} = require("canopen");
const {DataType} = require("canopen/source/types");

const [host, port, nodeId] = [process.argv[2], Number(process.argv[3]), Number(process.argv[4])];
const PATIENCE_MS = 15000;
const [COMMAND, SPEED, STATUSWORD] = [0x4000, 0x4001, 0x6041];
const [STOP_BIT, STF_BIT, RUN, UP_TO_FREQUENCY, ALARM, REMOTE] = [1, 2, 1, 8, 0x80, 1 << 9];
const E_OV3 = 0x22;

const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

// The Lawicel text protocol over TCP; data frames with 11-bit identifiers are all that this master knows.
class Slcan {
  constructor(socket, receive) {
    this.socket = socket;
    let text = "";
    socket.setNoDelay(true);
    socket.on("data", (bytes) => {
      const lines = (text + bytes.toString("latin1")).split("\r");
      text = lines.pop();
      for (const line of lines) {
        const frame = /^t([0-9A-Fa-f]{3})([0-8])((?:[0-9A-Fa-f]{2})*)/.exec(line);
        if (!frame) continue;
        const data = Buffer.from(frame[3].slice(0, 2 * frame[2]), "hex");
        receive({id: parseInt(frame[1], 16), len: data.length, data});
      }
    });
    socket.write("O\r");
  }
  send({id, data}) {
    this.socket.write(`t${id.toString(16).padStart(3, "0")}${data.length}${data.toString("hex")}\r`);
  }
}

async function until(what, condition) {
  const end = Date.now() + PATIENCE_MS;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > end) throw new Error(`not within ${PATIENCE_MS} ms: ${what}`);
    await sleep(5);
  }
}

async function main() {
  const socket = net.connect(port, host);
  await new Promise((resolve, reject) => socket.once("connect", resolve).once("error", reject));
  const master = new Device({id: 0x7e});
  const wire = new Slcan(socket, (frame) => master.receive(frame));
  master.on("message", (frame) => wire.send(frame));

  const states = [], emergencies = [], samples = [];
  master.eds.addSdoClientParameter(nodeId, 0x600 + nodeId, 0x580 + nodeId);
  master.eds.addHeartbeatConsumer(nodeId, 60000);
  master.eds.addEmcyConsumer(0x80 + nodeId);
  const word = (index, parameterName) => master.eds.addEntry(index, {parameterName, dataType: DataType.UNSIGNED16});
  const [command, speed] = [word(0x2100, "command"), word(0x2101, "speed")];
  const [status, frequency] = [word(0x2102, "status"), word(0x2103, "frequency")];
  master.eds.addTransmitPdo({cobId: 0x200 + nodeId, transmissionType: 255, dataObjects: [command, speed]});
  master.eds.addReceivePdo({cobId: 0x280 + nodeId, dataObjects: [status, frequency]});
  master.nmt.on("heartbeat", ({deviceId, state}) => states.push([deviceId, state]));
  master.emcy.on("emergency", ({em}) => emergencies.push(em));
  master.pdo.on("pdo", () => samples.push([Date.now(), frequency.value]));
  master.start();
  master.nmt.startNode();  // this device itself

  const object = {serverId: nodeId, timeout: PATIENCE_MS, subIndex: 0};
  const read = (index, dataType = DataType.UNSIGNED16, subIndex = 0) =>
    master.sdo.upload({...object, index, subIndex, dataType});
  const write = (index, data, dataType = DataType.UNSIGNED16, subIndex = 0) =>
    master.sdo.download({...object, index, subIndex, data, dataType});
  const refused = (code, promise) => assert.rejects(promise, (error) => error.code === code);
  const setPdo = (bits, rawHz) => {
    [command.value, speed.value] = [bits, rawHz];
    master.pdo.write(0x200 + nodeId);
  };
  const operational = async () => {
    master.nmt.startNode(nodeId);
    await until("NET mode", async () => (await read(STATUSWORD)) & REMOTE);
  };

  master.nmt.resetNode(nodeId);
  await until("the boot-up", () => states.some(([id, state]) => id === nodeId && state === 0));
  assert.strictEqual(await read(0x1000, DataType.UNSIGNED32), 0x10192);
  assert.strictEqual(await read(0x1008, DataType.VISIBLE_STRING), "E5NC");
  await refused(0x06020000, read(0x1018));
  await refused(0x06090011, read(0x1000, DataType.UNSIGNED32, 1));
  await refused(0x06010002, write(0x1000, 1, DataType.UNSIGNED32));
  await refused(0x06010001, read(0x2107));
  await refused(0x06070010, write(0x3007, 1, DataType.UNSIGNED32));
  await refused(0x08000021, write(0x3007, 20));
  await refused(0x05040001, write(0x3007, "more than four", DataType.VISIBLE_STRING));  // segmented
  const block = {...object, index: 0x1008, dataType: DataType.VISIBLE_STRING, blockTransfer: true};
  await refused(0x05040001, master.sdo.upload(block));

  await write(0x1801, (0x80000280 + nodeId) >>> 0, DataType.UNSIGNED32, 1);
  await write(0x1a01, COMMAND << 16 | 16, DataType.UNSIGNED32, 1);
  await write(0x1a01, 0x20000010, DataType.UNSIGNED32, 2);
  await write(0x1a01, 2, DataType.UNSIGNED8);
  await write(0x1801, 50, DataType.UNSIGNED16, 3);
  await write(0x1801, 0x280 + nodeId, DataType.UNSIGNED32, 1);
  await operational();
  await write(0x3007, 20);
  await write(0x3008, 10);
  await refused(0x06090030, write(0x3007, 36001));
  assert.strictEqual(await read(0x3007), 20);

  setPdo(STF_BIT, 4000);
  await until("up to frequency", () => status.value & UP_TO_FREQUENCY && frequency.value === 4000);
  const [first, last] = [samples.find(([, f]) => f >= 500), samples.find(([, f]) => f >= 3500)];
  const slope = (last[1] - first[1]) / 100 / ((last[0] - first[0]) / 1000);
  assert(Math.abs(slope / 25 - 1) < 0.1, `${slope} Hz/s, expected 25`);
  assert.strictEqual(await read(SPEED), 4000);

  setPdo(STOP_BIT, 0);
  const trip = await until("the emergency", () => emergencies[0]);
  assert.strictEqual(trip.code, 0x3210);
  assert.strictEqual(trip.register, 5);
  assert.deepStrictEqual([...trip.info], [0, E_OV3, 5, 0, 0]);
  assert(status.value & ALARM);
  assert.strictEqual((await read(0x3400)) & 0xff, E_OV3);
  await write(0x2107, 0);
  assert.strictEqual((await until("the end of the error", () => emergencies[1])).code, 0);
  await until("the end of the reset", () => read(0x3400).catch((error) => assert.strictEqual(error.code, 0x08000022)));
  await operational();
  setPdo(STF_BIT, 1000);
  await until("running again", () => status.value & RUN && frequency.value === 1000);
  setPdo(STOP_BIT, 0);
  await until("the stop", () => !(status.value & (RUN | ALARM)));
  master.stop();
  console.log(`ramp ${slope.toFixed(2)} Hz/s, ${samples.length} PDOs`);
  process.exit(0);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
