// Speaks to a run's stream with Foxglove's own client.
//
//   node dashboard_foxglove.mjs PAGE MODULES     of the page's address, and of node_modules
//
// Asserts what that library makes of the stream: channels, messages of one, a service's answer.
import assert from "node:assert/strict";
import { createRequire } from "node:module";

const [page, modules] = process.argv.slice(2);
const require = createRequire(`${modules}/`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");

const [base, token] = page.split("/#");
const address = `${base.replace("http:", "ws:")}/stream?token=${token}`;
const client = new FoxgloveClient({ ws: new WebSocket(address, [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) });
const once = (event) => new Promise((resolve) => client.on(event, resolve));
const late = setTimeout(() => assert.fail("no answer"), 60_000);
client.on("error", (error) => assert.fail(String(error)));

const [info, channels, services] = await Promise.all([once("serverInfo"), once("advertise"), once("advertiseServices")]);
for (const capability of ["time", "services", "assets", "playbackControl"]) {
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
clearTimeout(late);
client.close();
console.log("all heard");
