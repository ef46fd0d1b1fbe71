// Speaks to a run's stream with Foxglove's own client.
//
//   node dashboard_foxglove.mjs PAGE MODULES     of the page's address, and of node_modules
//
// Asserts what that library makes of the stream: channels, messages of two, a service's answer,
// parameters. A cloud of points is read by Foxglove's reader of ROS 2's messages.
import assert from "node:assert/strict";
import { createRequire } from "node:module";

const [page, modules] = process.argv.slice(2);
const require = createRequire(`${modules}/`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const WebSocket = require("ws");

const [base, token] = page.split("/#");
const address = `${base.replace("http:", "ws:")}/stream?token=${token}`;
const client = new FoxgloveClient({ ws: new WebSocket(address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const once = (event) => new Promise((resolve) => client.on(event, resolve));
const late = setTimeout(() => assert.fail("no answer"), 60_000);
client.on("error", (error) => assert.fail(String(error)));

const [info, channels, services] = await Promise.all([once("serverInfo"), once("advertise"), once("advertiseServices")]);
for (const capability of ["time", "services", "parameters", "parametersSubscribe", "assets", "playbackControl"]) {
  assert(info.capabilities.includes(capability), `${info.capabilities} lacks ${capability}`);
}
const truth = channels.find(({ topic }) => topic === "/truth");
assert(truth && truth.encoding === "json", JSON.stringify(channels.map(({ topic }) => topic)));
const subscription = client.subscribe(truth.id);
const message = await once("message");
assert.equal(message.subscriptionId, subscription);
assert(JSON.parse(new TextDecoder().decode(message.data)).sim_s >= 0);
assert(message.timestamp > 0n);

const state = services.find(({ name }) => name === "/state");
client.sendServiceCallRequest({
  serviceId: state.id, callId: 1, encoding: "json", data: new DataView(new TextEncoder().encode("{}").buffer),
});
const answer = await once("serviceCallResponse");
assert.equal(answer.callId, 1);
assert.equal(JSON.parse(new TextDecoder().decode(answer.data)).ok, true);

// A cloud: the points of a turn, each within the lidar's range.
const points = channels.find(({ topic }) => topic === "/points/lidar");
assert.deepEqual([points.encoding, points.schemaEncoding], ["cdr", "ros2msg"]);
const reader = new MessageReader(parse(points.schema, { ros2: true }));
const ofPoints = client.subscribe(points.id);
const cloud = reader.readMessage(await new Promise((resolve) => {
  client.on("message", ({ subscriptionId, data }) => subscriptionId === ofPoints && resolve(data));
}));
client.unsubscribe(ofPoints);
assert.equal(cloud.frame_id, "upper");
const { x, y, z, w } = cloud.pose.orientation;
assert(Math.abs(Math.hypot(x, y, z, w) - 1) < 1e-9, JSON.stringify(cloud.pose));
assert.deepEqual(cloud.fields.map(({ name, offset, type }) => [name, offset, type]),
  [["x", 0, 7], ["y", 4, 7], ["z", 8, 7], ["time", 12, 7], ["reflectivity", 16, 1], ["laser", 17, 1]]);
assert.equal(cloud.data.length % cloud.point_stride, 0);
assert(cloud.data.length / cloud.point_stride > 10_000, `${cloud.data.length} bytes`);
const floats = new DataView(cloud.data.buffer, cloud.data.byteOffset);
let before_s = 0;
for (let at = 0; at < cloud.data.length; at += cloud.point_stride) {
  const time_s = floats.getFloat32(at + 12, true);  // of a turn of 600 rpm, firing by firing
  assert(time_s > before_s - 1e-4 && time_s < 0.101, `${time_s} s after ${before_s} s`);
  before_s = time_s;
  const range = Math.hypot(...[0, 4, 8].map((offset) => floats.getFloat32(at + offset, true)));
  assert(range > 0.1 && range < 101, `${range} m`);
}

// Parameters: what `set` can set of the machine and of the devices.
const values = (id) => new Promise((resolve) => {
  const heard = (message) => {
    if (message.id !== id) return;
    client.off("parameterValues", heard);
    resolve(Object.fromEntries(message.parameters.map(({ name, value }) => [name, value])));
  };
  client.on("parameterValues", heard);
});
const complaint = () => new Promise((resolve) => {
  const heard = (message) => {
    if (message.level < 2) return;  // a warning: this viewer was too slow for the run
    client.off("status", heard);
    resolve(message);
  };
  client.on("status", heard);
});
client.getParameters([], "all");
const all = await values("all");
assert.equal(all["gnss.rate"], "1 Hz");
assert("lidar.fov.start" in all && "machine.boom" in all, Object.keys(all).join());
assert.equal(all["machine.boom"], undefined);

client.subscribeParameterUpdates(["lidar.rate", "machine.boom"]);
client.setParameters([{ name: "lidar.rate", value: "300 rpm" }, { name: "machine.boom", value: 0.25 }], "set");
assert.deepEqual(await values("set"), { "lidar.rate": "300 rpm", "machine.boom": 0.25 });
// Whoever changes it, who has subscribed is told: this client itself, and another, through a service.
const updated = async (name, wanted) => {
  for (let told = {}; told[name] !== wanted; told = await values(undefined));
};
await updated("lidar.rate", "300 rpm");
const set = services.find(({ name }) => name === "/set");
client.sendServiceCallRequest({
  serviceId: set.id, callId: 2, encoding: "json",
  data: new DataView(new TextEncoder().encode('{"on": "lidar", "set": {"rate": "600 rpm"}}').buffer),
});
await updated("lidar.rate", "600 rpm");

// What is refused is said, and changes nothing.
for (const [name, value, why] of [["lidar.rate", "9 rpm", /lidar: .*300/], ["gnss.colour", 1, /cannot be changed/],
                                  ["nothing", 1, /no parameter/], ["machine.boom", 2, /-1/]]) {
  const said = complaint();
  client.setParameters([{ name, value }], `refused ${name}`);
  const { level, message } = await said;
  assert.equal(level, 2);
  assert.match(message, why);
}
client.getParameters(["lidar.rate", "machine.boom"], "after");
assert.deepEqual(await values("after"), { "lidar.rate": "600 rpm", "machine.boom": 0.25 });
// A hand lets go where there is no value.
client.setParameters([{ name: "machine.boom" }], "let go");
assert.deepEqual(await values("let go"), { "machine.boom": undefined });
clearTimeout(late);
client.close();
console.log("all heard");
