// The machine in its scene: the present ground, the things on it, every link at its pose, the
// points that a client of the lidars sees, fixes beside their antennas, contacts, the way driven.
// World axes: x east, y north, z up, metres.

import * as THREE from "/lib/three/build/three.module.js";
import { OrbitControls } from "/lib/three/examples/jsm/controls/OrbitControls.js";
import { Air } from "/page/air.js";
import { readGlb } from "/page/glb.js";

const MOST_POINTS = 200000; // of one lidar
const MOST_PATH = 5000;
const MOST_FIXES = 200;
const PATH_STEP_M = 0.2;
const FARTHEST_RANGE_M = 60; // end of the colours
const RINGS = 32;
const EARTH_M = 6378137;
const NEWTONS_PER_M = 20000; // of a force's arrow
const QUICK_MS = 25; // for one picture
const REST = 3; // times as long as a picture that took longer
const LONGEST_REST_MS = 1000; // a tab that was hidden took no time to draw

// From blue (near) by green and yellow to red.
function rainbow(share, colours, at) {
  const hue = 0.66 * (1 - Math.min(1, Math.max(0, share)));
  const part = (shift) => Math.min(1, Math.max(0, Math.abs(((hue + shift) % 1) * 6 - 3) - 1));
  colours[at] = part(0);
  colours[at + 1] = part(2 / 3);
  colours[at + 2] = part(1 / 3);
}

function matrixOf(pose, scale) {
  const { position: p, orientation: q } = pose;
  return new THREE.Matrix4().compose(
    new THREE.Vector3(p.x, p.y, p.z),
    new THREE.Quaternion(q.x, q.y, q.z, q.w),
    new THREE.Vector3(scale.x, scale.y, scale.z),
  );
}

export class View {
  constructor(run, canvas, cameraChoice, colourChoice, figures) {
    this.run = run;
    this.canvas = canvas;
    this.cameraChoice = cameraChoice;
    this.colourChoice = colourChoice;
    this.figures = figures;
    this.frames = new Map([["world", new THREE.Group()]]); // name -> group
    this.entities = new Map(); // id -> {url, show(matrix), remove()}
    this.models = new Map(); // url -> promise of [{geometry, material}]
    this.clouds = new Map(); // topic -> {points, count, clouds, received}
    this.fixes = new Map(); // device -> {spheres, latest}
    this.drawnAt = 0; // ms
    this.rested = true; // since then
    this.count = { frames: 0, transforms: 0, clouds: 0, points: 0 };
    this.pathAt = null;
    this.beforeDrawing = () => {}; // of what is drawn here by others
    this.figuresOf = () => "";
    this.setUp();
    run.listen("/scene", (update) => this.updateScene(update));
    run.listen("/tf", (message) => this.move(message.transforms));
    run.listen("/truth", (truth) => this.showTruth(truth));
    run.listen("/antenna", (place) => this.showAntenna(place));
    run.addEventListener("topics", () => this.hearDevices());
    this.hearDevices();
    this.draw(0);
  }

  setUp() {
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: false });
    this.renderer.gammaOutput = true;
    this.renderer.gammaFactor = 2.2;
    this.scene = new THREE.Scene();
    this.scene.add(this.frames.get("world"));
    this.camera = new THREE.PerspectiveCamera(50, 1, 0.2, 3000);
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(-14, -12, 9);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.target.set(0, 0, 1);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    const sun = new THREE.DirectionalLight(0xfff4e0, 1.5);
    sun.position.set(-0.4, -0.7, 1);
    this.scene.add(sun, new THREE.HemisphereLight(0xcfe4ff, 0x6f6350, 0.9));
    this.air = new Air(this.run, this.scene);
    this.path = new THREE.Line(
      new THREE.BufferGeometry().setAttribute("position", this.dynamic(MOST_PATH)),
      new THREE.LineBasicMaterial({ color: 0xff8c00, fog: false }),
    );
    this.path.frustumCulled = false;
    this.path.geometry.setDrawRange(0, 0);
    this.force = new THREE.ArrowHelper(new THREE.Vector3(0, 0, 1), new THREE.Vector3(), 1, 0xff2020);
    this.force.visible = false;
    this.scene.add(this.path, this.force);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    this.cameraChoice.addEventListener("change", () => this.aim());
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    this.inSight = true; // scrolled away it is not drawn
    new IntersectionObserver(([{ isIntersecting }]) => (this.inSight = isIntersecting)).observe(this.canvas);
    this.resize();
  }

  dynamic(count) {
    return new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  frame(name) {
    if (!this.frames.has(name)) {
      const group = new THREE.Group();
      this.frames.set(name, group);
      this.scene.add(group);
    }
    return this.frames.get(name);
  }

  // Things in the scene ----------------------------------------------------------------------------

  model(url) {
    if (!this.models.has(url)) {
      this.models.set(
        url,
        this.run.asset(url).then((buffer) =>
          readGlb(buffer).map(({ positions, indices, colours, colour }) => {
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
            geometry.setIndex(new THREE.BufferAttribute(indices, 1));
            if (colours) {
              const rgb = new Uint8Array((colours.length / 4) * 3);
              for (let i = 0; i < colours.length / 4; ++i) rgb.set(colours.subarray(4 * i, 4 * i + 3), 3 * i);
              geometry.setAttribute("color", new THREE.BufferAttribute(rgb, 3, true));
            }
            geometry.computeBoundingSphere();
            const material = new THREE.MeshPhongMaterial({
              shininess: 4,
              color: new THREE.Color(...colour),
              vertexColors: colours ? THREE.VertexColors : THREE.NoColors,
              side: THREE.DoubleSide,
              flatShading: true,
            });
            return { geometry, material };
          }),
        ),
      );
    }
    return this.models.get(url);
  }

  async updateScene(update) {
    const alike = new Map(); // url and frame -> entities that are new
    for (const entity of update.entities) {
      const model = entity.models[0];
      const known = this.entities.get(entity.id);
      const matrix = matrixOf(model.pose, model.scale);
      if (known?.url === model.url) {
        known.show(matrix);
        continue;
      }
      const key = `${entity.frame_id}\n${model.url}`;
      if (!alike.has(key)) alike.set(key, []);
      alike.get(key).push({ id: entity.id, frame: entity.frame_id, url: model.url, matrix });
    }
    for (const list of alike.values()) {
      this.model(list[0].url)
        .then((parts) => this.place(list, parts))
        .catch((error) => this.run.tell("status", { level: 2, message: error.message }));
    }
  }

  // Things of one model: as many instances of it.
  place(list, parts) {
    const meshes = parts.map(({ geometry, material }) => {
      const mesh = new THREE.InstancedMesh(geometry, material, list.length);
      mesh.frustumCulled = false;
      this.frame(list[0].frame).add(mesh);
      return mesh;
    });
    list.forEach(({ id, url, matrix }, index) => {
      this.entities.get(id)?.remove();
      const show = (to) => {
        for (const mesh of meshes) {
          mesh.setMatrixAt(index, to);
          mesh.instanceMatrix.needsUpdate = true;
        }
      };
      show(matrix);
      const remove = () => {
        if (list.length > 1) {
          show(new THREE.Matrix4().makeScale(0, 0, 0));
          return;
        }
        for (const mesh of meshes) {
          mesh.parent.remove(mesh);
          mesh.geometry.dispose();
          mesh.material.dispose();
        }
        this.models.delete(url);
      };
      this.entities.set(id, { url, show, remove });
    });
  }

  // What moves -------------------------------------------------------------------------------------

  move(transforms) {
    ++this.count.transforms;
    for (const { child_frame_id: name, translation: p, rotation: q } of transforms) {
      const group = this.frame(name);
      group.position.set(p.x, p.y, p.z);
      group.quaternion.set(q.x, q.y, q.z, q.w);
    }
    this.carrier = transforms[0]?.child_frame_id;
    this.last = transforms.map((one) => one.child_frame_id);
  }

  showTruth(truth) {
    const [x, y, z] = truth.position_m;
    const place = new THREE.Vector3(x, y, z + 0.15);
    if (!this.pathAt || this.pathAt.distanceTo(place) > PATH_STEP_M) {
      this.pathAt = place;
      const attribute = this.path.geometry.attributes.position;
      const count = this.path.geometry.drawRange.count;
      if (count === MOST_PATH) attribute.array.copyWithin(0, 3);
      place.toArray(attribute.array, 3 * Math.min(count, MOST_PATH - 1));
      attribute.needsUpdate = true;
      this.path.geometry.setDrawRange(0, Math.min(count + 1, MOST_PATH));
    }
    const contact = truth.contact;
    this.force.visible = Boolean(contact?.touching);
    if (this.force.visible) {
      const force = new THREE.Vector3(...contact.force_n);
      this.force.position.set(...contact.place_m);
      this.force.setDirection(force.clone().normalize());
      this.force.setLength(0.5 + force.length() / NEWTONS_PER_M, 0.3, 0.2);
    }
  }

  // What clients read ------------------------------------------------------------------------------

  hearDevices() {
    for (const topic of this.run.topics.keys()) {
      if (topic.startsWith("/points/") && !this.clouds.has(topic)) {
        this.clouds.set(topic, this.cloud());
        this.run.listen(topic, (message) => this.showPoints(topic, message));
      } else if (topic.startsWith("/fix/") && !this.fixes.has(topic.slice(5))) {
        this.fixes.set(topic.slice(5), this.fixMarks());
        this.run.listen(topic, (fix) => this.showFix(topic.slice(5), fix));
      }
    }
  }

  cloud() {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.dynamic(MOST_POINTS));
    geometry.setAttribute("color", this.dynamic(MOST_POINTS));
    geometry.setDrawRange(0, 0);
    const points = new THREE.Points(
      geometry,
      new THREE.PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: THREE.VertexColors, fog: false }),
    );
    points.frustumCulled = false;
    return { points };
  }

  showPoints(topic, message) {
    const { points } = this.clouds.get(topic);
    const bytes = message.data;
    const data = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const stride = message.point_stride;
    const offset = Object.fromEntries(message.fields.map((field) => [field.name, field.offset]));
    const count = Math.min(Math.floor(bytes.length / stride), MOST_POINTS);
    const places = points.geometry.attributes.position.array;
    const colours = points.geometry.attributes.color.array;
    const by = this.colourChoice.value;
    const turn_s = (count > 0 && data.getFloat32((count - 1) * stride + offset.time, true)) || 1;
    for (let i = 0; i < count; ++i) {
      const at = i * stride;
      const x = data.getFloat32(at + offset.x, true);
      const y = data.getFloat32(at + offset.y, true);
      const z = data.getFloat32(at + offset.z, true);
      places[3 * i] = x;
      places[3 * i + 1] = y;
      places[3 * i + 2] = z;
      const share =
        by === "reflectivity"
          ? data.getUint8(at + offset.reflectivity) / 100
          : by === "laser"
            ? (data.getUint8(at + offset.laser) % RINGS) / RINGS
            : by === "time"
              ? data.getFloat32(at + offset.time, true) / turn_s
              : Math.hypot(x, y, z) / FARTHEST_RANGE_M;
      rainbow(share, colours, 3 * i);
    }
    points.geometry.attributes.position.needsUpdate = true;
    points.geometry.attributes.color.needsUpdate = true;
    points.geometry.setDrawRange(0, by === "none" ? 0 : count);
    points.matrixAutoUpdate = false;
    points.matrix.copy(matrixOf(message.pose, { x: 1, y: 1, z: 1 }));
    this.frame(message.frame_id).add(points);
    ++this.count.clouds;
    this.count.points += count;
    this.cloudPoints = count;
  }

  fixMarks() {
    const sphere = new THREE.SphereBufferGeometry(0.12, 10, 8);
    const group = new THREE.Group();
    const antenna = new THREE.Mesh(sphere, new THREE.MeshBasicMaterial({ color: 0x00c853 }));
    antenna.visible = false;
    const fixes = new THREE.Points(
      new THREE.BufferGeometry().setAttribute("position", this.dynamic(MOST_FIXES)),
      new THREE.PointsMaterial({ size: 7, sizeAttenuation: false, color: 0xff00c8, depthTest: false, fog: false }),
    );
    fixes.frustumCulled = false;
    fixes.geometry.setDrawRange(0, 0);
    const ellipse = new THREE.LineLoop(
      new THREE.BufferGeometry().setFromPoints(
        Array.from({ length: 48 }, (_, i) => new THREE.Vector3(Math.cos((i * Math.PI) / 24), Math.sin((i * Math.PI) / 24), 0))),
      new THREE.LineBasicMaterial({ color: 0xff00c8, depthTest: false, fog: false }),
    );
    const error = new THREE.Line(
      new THREE.BufferGeometry().setAttribute("position", this.dynamic(2)),
      new THREE.LineBasicMaterial({ color: 0xff00c8, depthTest: false, fog: false }),
    );
    error.frustumCulled = false;
    ellipse.visible = error.visible = false;
    // A fix may lie within the machine or below ground: over all that is drawn before.
    for (const mark of [fixes, ellipse, error]) mark.renderOrder = 1;
    group.add(antenna, fixes, ellipse, error);
    this.scene.add(group);
    return { antenna, fixes, ellipse, error, latest: null, number: 0 };
  }

  showFix(device, fix) {
    const marks = this.fixes.get(device);
    marks.latest = fix;
    const { attributes } = marks.fixes.geometry;
    attributes.position.array.set(fix.position_m, 3 * (marks.number++ % MOST_FIXES));
    attributes.position.needsUpdate = true;
    marks.fixes.geometry.setDrawRange(0, Math.min(marks.number, MOST_FIXES));
    const [east, north] = [fix.position_covariance[0], fix.position_covariance[4]].map(Math.sqrt);
    marks.ellipse.visible = fix.position_covariance_type !== 0 && east > 0 && north > 0;
    marks.ellipse.position.set(...fix.position_m);
    marks.ellipse.scale.set(east, north, 1);
    marks.sure = marks.ellipse.visible
      ? `${fix.position_covariance_type === 1 ? ", guessed" : ","} 1σ ${Math.max(east, north).toFixed(2)} m` : "";
  }

  // The antenna itself, from the fix that is nearest to it: degrees apart are metres apart.
  showAntenna(place) {
    const marks = this.fixes.get(place.frame_id);
    const fix = marks?.latest;
    if (!fix) return;
    const radians = Math.PI / 180;
    const [x, y, z] = fix.position_m;
    marks.antenna.visible = true;
    marks.antenna.position.set(
      x + (place.longitude - fix.longitude) * radians * EARTH_M * Math.cos(fix.latitude * radians),
      y + (place.latitude - fix.latitude) * radians * EARTH_M,
      z + place.altitude - fix.altitude,
    );
    const { position } = marks.error.geometry.attributes;
    position.array.set([x, y, z, ...marks.antenna.position.toArray()]);
    position.needsUpdate = true;
    marks.error.visible = true;
    marks.apart_m = marks.antenna.position.distanceTo(new THREE.Vector3(x, y, z));
  }

  // Where from -------------------------------------------------------------------------------------

  key(event) {
    const turn = { ArrowLeft: [-0.08, 0], ArrowRight: [0.08, 0], ArrowUp: [0, -0.05], ArrowDown: [0, 0.05] }[event.key];
    const zoom = { "+": 0.9, "-": 1.1 }[event.key];
    const arm = this.camera.position.clone().sub(this.controls.target);
    if (turn) {
      const sphere = new THREE.Spherical().setFromVector3(new THREE.Vector3(arm.y, arm.z, arm.x));
      sphere.theta += turn[0];
      sphere.phi = Math.min(0.49 * Math.PI, Math.max(0.05, sphere.phi + turn[1]));
      const turned = new THREE.Vector3().setFromSpherical(sphere);
      this.camera.position.copy(this.controls.target).add(new THREE.Vector3(turned.z, turned.x, turned.y));
    } else if (zoom) {
      this.camera.position.copy(this.controls.target).add(arm.multiplyScalar(zoom));
    } else {
      return;
    }
    event.preventDefault();
  }

  aim() {
    const at = this.frames.get(this.carrier)?.position ?? new THREE.Vector3();
    if (this.cameraChoice.value === "top") {
      this.controls.target.copy(at);
      this.camera.position.copy(at).add(new THREE.Vector3(0, -0.1, 45));
    } else if (this.camera.position.distanceTo(at) > 40 || this.camera.position.z > at.z + 30 || this.wasCab) {
      this.controls.target.copy(at);
      this.camera.position.copy(at).add(new THREE.Vector3(-14, -12, 9));
    }
    this.wasCab = this.cameraChoice.value === "cab";
  }

  follow() {
    const group = this.frames.get(this.cab ?? this.carrier);
    const choice = this.cameraChoice.value;
    this.controls.enabled = choice !== "cab";
    if (!group) return;
    if (choice === "cab") {
      const upper = this.frames.get("upper") ?? group;
      this.camera.position.set(0.9, 0.75, 2.0).applyQuaternion(upper.quaternion).add(upper.position);
      this.camera.up.set(0, 0, 1);
      this.camera.lookAt(new THREE.Vector3(8, 0.4, 0.2).applyQuaternion(upper.quaternion).add(upper.position));
      return;
    }
    if (choice === "follow" || choice === "top") {
      const way = group.position.clone().sub(this.followed ?? group.position);
      this.controls.target.add(way);
      this.camera.position.add(way);
      if (!this.followed) {
        this.controls.target.copy(group.position).add(new THREE.Vector3(0, 0, 1));
        this.camera.position.copy(group.position).add(new THREE.Vector3(-11, -10, 7));
      }
    }
    this.followed = group.position.clone();
    this.controls.update();
  }

  // A picture that took long, as one that a processor draws, is followed by a pause thrice as long: the page may be
  // open on the machine that runs in real time. A browser calls again when the picture before is drawn.
  draw(now) {
    const took = now - this.drawnAt;
    if (took > QUICK_MS && !this.rested) {
      this.rested = true;
      setTimeout(() => requestAnimationFrame((later) => this.draw(later)), Math.min(REST * took, LONGEST_REST_MS));
      return;
    }
    requestAnimationFrame((later) => this.draw(later));
    if (!this.inSight) return;
    this.rested = false;
    this.drawnAt = now;
    this.follow();
    this.beforeDrawing();
    this.renderer.render(this.scene, this.camera);
    ++this.count.frames;
    if (this.count.frames % 15 === 0) {
      const { triangles } = this.renderer.info.render;
      const apart = [...this.fixes].filter(([, marks]) => marks.apart_m !== undefined);
      this.figures.textContent =
        `${triangles.toLocaleString("en")} triangles, ${(this.cloudPoints ?? 0).toLocaleString("en")} points a turn` +
        apart.map(([name, marks]) => `, ${name} ${marks.apart_m.toFixed(2)} m from its antenna${marks.sure}`).join("") +
        this.air.words() +
        this.figuresOf();
    }
  }
}
