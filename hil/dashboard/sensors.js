// The machine's sensors at their mounts, with what their clients receive: axes of inertial units,
// cameras with the pictures that a client takes (or with previews, while none does), satellites as
// lines from each receiver. Only the ticked ones are subscribed to.

import * as THREE from "/lib/three/build/three.module.js";

const AXES_M = 0.6;
const FRUSTUM_M = 1.6; // distance of its picture from a camera
const ROUND = 64; // sides of the picture of an all-round camera
const SATELLITE_M = 14; // of a line
const MOST_SATELLITES = 64;
const SKY = { used: 0x00e676, received: 0xffc400, lost: 0xff5252 };
const RADIANS = Math.PI / 180;

export class Sensors {
  // `choices`: tick boxes {axes, cameras, satellites}. `pictures`: their element in the page.
  constructor(run, view, choices, pictures) {
    this.run = run;
    this.view = view;
    this.choices = choices;
    this.pictures = pictures;
    this.shown = new Map(); // sensor -> {kind, group}
    this.cameras = new Map(); // topic -> {canvas, caption, texture, picture, count, previews}
    this.skies = new Map(); // topic -> {lines, told}
    this.ends = new Map(); // topic -> function that unsubscribes
    run.listen("/sensors", ({ sensors }) => this.place(sensors));
    run.addEventListener("topics", () => this.watch());
    for (const box of Object.values(choices)) box.addEventListener("change", () => this.watch());
    view.figuresOf = () => this.words();
    view.beforeDrawing = () => this.follow();
  }

  place(sensors) {
    for (const sensor of sensors) {
      if (this.shown.has(sensor.name)) continue;
      const { position: p, orientation: q } = sensor;
      const group = new THREE.Group();
      group.position.set(p.x, p.y, p.z);
      group.quaternion.set(q.x, q.y, q.z, q.w);
      if (sensor.kind === "imu") group.add(this.axes());
      if (sensor.kind === "camera") group.add(...this.frustum(sensor));
      this.view.frame(sensor.frame).add(group);
      this.shown.set(sensor.name, { kind: sensor.kind, group });
    }
    this.watch();
  }

  // x red, y green, z blue; drawn over what hides them, as the unit is within its link.
  axes() {
    const axes = new THREE.AxesHelper(AXES_M);
    axes.material.fog = false;
    axes.material.depthTest = false;
    axes.renderOrder = 1;
    return axes;
  }

  // Its picture FRUSTUM_M in front of a camera, and the lines that go there: x forward, y left, z up.
  frustum({ name, horizontal_rad: wide, vertical_rad: high }) {
    const round = wide > 0.9 * Math.PI;
    const sides = round ? ROUND : 1;
    const up = FRUSTUM_M * Math.tan(Math.min(high, 2.6) / 2);
    const places = [];
    const corners = [];
    const uv = [];
    for (let side = 0; side <= sides; ++side) {
      const share = side / sides;
      const angle = wide * (0.5 - share);
      const across = FRUSTUM_M * Math.tan(wide / 2) * (1 - 2 * share);
      const [x, y] = round ? [FRUSTUM_M * Math.cos(angle), FRUSTUM_M * Math.sin(angle)] : [FRUSTUM_M, across];
      places.push(x, y, up, x, y, -up);
      uv.push(share, 1, share, 0);
      if (side > 0) corners.push(2 * side - 2, 2 * side - 1, 2 * side, 2 * side - 1, 2 * side + 1, 2 * side);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(places, 3));
    geometry.setAttribute("uv", new THREE.Float32BufferAttribute(uv, 2));
    geometry.setIndex(corners);
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = 1;
    const texture = new THREE.CanvasTexture(canvas);
    texture.encoding = THREE.sRGBEncoding;
    texture.minFilter = THREE.LinearFilter;
    texture.generateMipmaps = false;
    const picture = new THREE.Mesh(
      geometry, new THREE.MeshBasicMaterial({ map: texture, side: THREE.DoubleSide, transparent: true, opacity: 0.85, fog: false }));
    picture.visible = false; // until there is one
    const edges = [];
    const last = 2 * sides;
    for (const corner of round ? [] : [0, 1, last, last + 1]) edges.push(0, 0, 0, ...places.slice(3 * corner, 3 * corner + 3));
    for (let side = 0; side < sides; ++side) {
      for (const row of [0, 1]) {
        edges.push(...places.slice(6 * side + 3 * row, 6 * side + 3 * row + 3));
        edges.push(...places.slice(6 * side + 6 + 3 * row, 6 * side + 9 + 3 * row));
      }
    }
    if (!round) for (const corner of [0, last]) edges.push(...places.slice(3 * corner, 3 * corner + 6));
    const lines = new THREE.LineSegments(
      new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(edges, 3)),
      new THREE.LineBasicMaterial({ color: 0x40c4ff, fog: false }));
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.textContent = `${name}: no picture yet; a preview comes when time goes on`;
    figure.append(canvas, caption);
    this.pictures.append(figure);
    this.cameras.set(`/camera/${name}`, { name, canvas, caption, figure, texture, picture, count: 0, previews: 0 });
    return [lines, picture];
  }

  watch() {
    const { axes, cameras, satellites } = this.choices;
    for (const { kind, group } of this.shown.values()) {
      if (kind === "imu") group.visible = axes.checked;
      if (kind === "camera") group.visible = cameras.checked;
    }
    this.pictures.hidden = !cameras.checked || this.cameras.size === 0;
    for (const topic of this.run.topics.keys()) {
      if (topic.startsWith("/camera/")) {
        this.hear(topic, cameras.checked && this.cameras.has(topic), (picture) => this.showPicture(topic, picture));
      } else if (topic.startsWith("/satellites/")) {
        this.hear(topic, satellites.checked, (sky) => this.showSky(topic, sky));
      }
    }
    for (const sky of this.skies.values()) sky.lines.visible = satellites.checked;
  }

  hear(topic, wanted, use) {
    if (wanted && !this.ends.has(topic)) {
      this.ends.set(topic, this.run.listen(topic, use));
    } else if (!wanted) {
      this.ends.get(topic)?.();
      this.ends.delete(topic);
    }
  }

  // The block of a preview is 0. `remark`: how the picture is to be read.
  showPicture(topic, { width, height, encoding, data: bytes, block, sent_width, sent_height, remark }) {
    const camera = this.cameras.get(topic);
    const image = new ImageData(width, height);
    const bands = encoding === "rgb8" ? 3 : 1;
    for (let i = 0; i < width * height; ++i) {
      for (let band = 0; band < 3; ++band) image.data[4 * i + band] = bytes[bands * i + (bands === 3 ? band : 0)];
      image.data[4 * i + 3] = 255;
    }
    if (camera.canvas.width !== width || camera.canvas.height !== height) {
      Object.assign(camera.canvas, { width, height });
      camera.texture.dispose(); // of another size
    }
    camera.canvas.getContext("2d").putImageData(image, 0, 0);
    camera.texture.needsUpdate = true;
    camera.picture.visible = true;
    const isPreview = Number(block) === 0;
    const what = isPreview ? "" : `picture ${block}, ${sent_width} × ${sent_height}`;
    camera.caption.textContent = `${camera.name}: ${[what, remark].filter(Boolean).join("; ")}`;
    ++camera[isPreview ? "previews" : "count"];
  }

  showSky(topic, { from, satellites }) {
    if (!this.skies.has(topic)) this.skies.set(topic, { lines: this.skyLines(), told: null });
    const sky = this.skies.get(topic);
    sky.told = { from, satellites };
    const { position, color } = sky.lines.geometry.attributes;
    const count = Math.min(satellites.length, MOST_SATELLITES);
    satellites.slice(0, count).forEach(({ azimuth_deg, elevation_deg, cn0_dbhz, used }, i) => {
      const level = Math.cos(elevation_deg * RADIANS);
      const way = [Math.sin(azimuth_deg * RADIANS) * level, Math.cos(azimuth_deg * RADIANS) * level, Math.sin(elevation_deg * RADIANS)];
      position.array.set([0, 0, 0, ...way.map((part) => SATELLITE_M * part)], 6 * i);
      const ink = new THREE.Color(used ? SKY.used : cn0_dbhz > 0 ? SKY.received : SKY.lost);
      color.array.set([ink.r, ink.g, ink.b, ink.r, ink.g, ink.b], 6 * i);
    });
    position.needsUpdate = color.needsUpdate = true;
    sky.lines.geometry.setDrawRange(0, 2 * count);
  }

  skyLines() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.view.dynamic(2 * MOST_SATELLITES));
    geometry.setAttribute("color", this.view.dynamic(2 * MOST_SATELLITES));
    const lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors, fog: false }));
    lines.frustumCulled = false;
    this.view.scene.add(lines);
    return lines;
  }

  // Lines begin at the antenna, or where the receiver says that it is.
  follow() {
    for (const [topic, { lines }] of this.skies) {
      const marks = this.view.fixes.get(topic.slice("/satellites/".length));
      if (marks?.antenna.visible) lines.position.copy(marks.antenna.position);
      else if (marks?.latest) lines.position.set(...marks.latest.position_m);
    }
  }

  words() {
    if (!this.choices.satellites.checked) return "";
    return [...this.skies].filter(([, { told }]) => told).map(([topic, { told: { from, satellites } }]) => {
      const used = satellites.filter((one) => one.used).length;
      const heard = satellites.filter((one) => !one.used && one.cn0_dbhz > 0).length;
      return `, ${topic.slice("/satellites/".length)} uses ${used} satellites (${from}), ` +
        `receives ${heard} more, ${satellites.length - used - heard} not`;
    }).join("");
  }
}
