// The run as the page knows it: its stream (Foxglove's WebSocket protocol, docs/dashboard.md) and its
// control surface (docs/control.md). It comes back by itself when the connection was lost.

import { cdrReader } from "/page/cdr.js";

const SUBPROTOCOLS = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
// After a loss: soon at first, since a recording that is sent back is away for a moment.
const FIRST_RETRY_MS = 200;
const RETRY_MS = 1000;

// Opcodes of the server's binary frames (protocols/foxglove/frames.h).
const MESSAGE = 1;
const TIME = 2;
const ASSET = 4;

export class Run extends EventTarget {
  constructor() {
    super();
    this.token = location.hash.slice(1);
    this.topics = new Map(); // topic -> channel
    this.listeners = new Map(); // topic -> callbacks
    this.subscriptions = new Map(); // id -> topic
    this.assets = new Map(); // request -> {resolve, reject}
    this.nextId = 1;
    this.text = new TextDecoder();
    this.retry_ms = RETRY_MS;
    this.connect();
  }

  // Calls `use(message, time_ns)` for each message of that topic, also after a reconnection.
  // Returns what ends it.
  listen(topic, use) {
    if (!this.listeners.has(topic)) this.listeners.set(topic, new Set());
    this.listeners.get(topic).add(use);
    this.subscribe(topic);
    return () => {
      this.listeners.get(topic)?.delete(use);
      if (this.listeners.get(topic)?.size === 0) this.unsubscribe(topic);
    };
  }

  // A request to the control surface: what it answers. Throws an Error that says why not.
  async command(verb, keys = {}) {
    const response = await fetch("/command", {
      method: "POST",
      headers: { Authorization: `Bearer ${this.token}` },
      body: JSON.stringify({ verb, ...keys }),
    });
    const reply = await response.json();
    if (!reply.ok) {
      const named = reply.path && !reply.what.includes(reply.path) ? `${reply.path}: ${reply.what}` : reply.what;
      throw new Error([named, reply.found && `found ${reply.found}`, reply.allowed && `allowed ${reply.allowed}`]
        .filter(Boolean).join("; "));
    }
    return reply;
  }

  // The file that a message names, as an ArrayBuffer.
  asset(uri) {
    const requestId = this.nextId++;
    return new Promise((resolve, reject) => {
      this.assets.set(requestId, { resolve, reject });
      this.send({ op: "fetchAsset", uri, requestId });
    });
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/stream?token=${this.token}`, SUBPROTOCOLS);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) =>
      typeof data === "string" ? this.receive(JSON.parse(data)) : this.receiveFrame(data);
    socket.onclose = () => {
      this.topics.clear();
      this.subscriptions.clear();
      for (const { reject } of this.assets.values()) reject(new Error("the connection was lost"));
      this.assets.clear();
      this.tell("lost");
      setTimeout(() => this.connect(), this.retry_ms);
      this.retry_ms = RETRY_MS;
    };
    this.socket = socket;
  }

  receive(message) {
    switch (message.op) {
      case "serverInfo":
        // Another run at the same address is another world: everything is drawn anew.
        if (this.session && this.session !== message.sessionId) {
          this.socket.onmessage = this.socket.onclose = null;
          this.socket.close();
          location.reload();
          return;
        }
        this.session = message.sessionId;
        this.retry_ms = FIRST_RETRY_MS;
        this.tell("open", message);
        break;
      case "advertise":
        for (const channel of message.channels) {
          const read = channel.encoding === "cdr" ? cdrReader(channel.schema) : (bytes) => JSON.parse(this.text.decode(bytes));
          this.topics.set(channel.topic, { ...channel, read });
        }
        for (const topic of this.listeners.keys()) this.subscribe(topic);
        this.tell("topics");
        break;
      case "status":
        this.tell("status", message);
        break;
    }
  }

  receiveFrame(data) {
    const view = new DataView(data);
    switch (view.getUint8(0)) {
      case MESSAGE: {
        const topic = this.subscriptions.get(view.getUint32(1, true));
        const time = view.getBigUint64(5, true);
        const message = this.topics.get(topic)?.read(new Uint8Array(data, 13));
        for (const use of this.listeners.get(topic) ?? []) use(message, time);
        break;
      }
      case TIME:
        this.tell("time", view.getBigUint64(1, true));
        break;
      case ASSET: {
        const asked = this.assets.get(view.getUint32(1, true));
        this.assets.delete(view.getUint32(1, true));
        const errorSize = view.getUint32(6, true);
        const rest = new Uint8Array(data, 10);
        if (view.getUint8(5) === 0) asked?.resolve(data.slice(10 + errorSize));
        else asked?.reject(new Error(this.text.decode(rest.subarray(0, errorSize))));
        break;
      }
    }
  }

  subscribe(topic) {
    const channel = this.topics.get(topic);
    if (!channel || [...this.subscriptions.values()].includes(topic)) return;
    const id = this.nextId++;
    this.subscriptions.set(id, topic);
    this.send({ op: "subscribe", subscriptions: [{ id, channelId: channel.id }] });
  }

  unsubscribe(topic) {
    this.listeners.delete(topic);
    for (const [id, subscribed] of this.subscriptions) {
      if (subscribed !== topic) continue;
      this.subscriptions.delete(id);
      this.send({ op: "unsubscribe", subscriptionIds: [id] });
    }
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
