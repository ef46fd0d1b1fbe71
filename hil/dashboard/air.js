// The air as in the truth: rain, snow, fog and haze evenly dim distant things, dust is in puffs.
// The thinning of fog with height is not drawn.

import * as THREE from "/lib/three/build/three.module.js";

const MOST_PUFFS = 200;
const DUST = 0xa8906c;
const FOG = { light: 0xc9d0d6, dark: 0x59616a };
const SKY = { light: 0xc7dcee, dark: 0x0e1113 };
const SKY_M = 1000; // of air, before the sky
const CONTRAST = Math.log(20); // extinction times the meteorological optical range
const SIGMAS = 3; // to the edge of a puff's picture
const PUFF_PX = 64;

// Beer and Lambert; of its own three.js has a square in it.
THREE.ShaderChunk.fog_fragment = `
#ifdef USE_FOG
  gl_FragColor.rgb = mix(gl_FragColor.rgb, fogColor, 1.0 - exp(-fogDensity * fogDepth));
#endif`;

export class Air {
  constructor(run, scene) {
    this.scene = scene;
    this.told = { rain_mmph: 0, snow_mmph: 0, extinction_pm: 0, dust: [] };
    this.puffs = [];
    this.puffPicture = this.paintPuff();
    scene.fog = new THREE.FogExp2(0, 0);
    scene.background = new THREE.Color();
    this.dark = matchMedia("(prefers-color-scheme: dark)");
    this.dark.addEventListener("change", () => this.dim());
    this.dim();
    run.listen("/air", (air) => this.show(air));
  }

  show(air) {
    this.told = air;
    this.dim();
    while (this.puffs.length < Math.min(air.dust.length, MOST_PUFFS)) {
      const puff = new THREE.Sprite(
        new THREE.SpriteMaterial({ map: this.puffPicture, color: DUST, transparent: true, depthWrite: false, fog: false }));
      this.scene.add(puff);
      this.puffs.push(puff);
    }
    this.puffs.forEach((puff, i) => {
      puff.visible = i < air.dust.length;
      if (!puff.visible) return;
      const [x, y, z, sigma, depth] = air.dust[i];
      puff.position.set(x, y, z);
      puff.scale.setScalar(2 * SIGMAS * sigma);
      puff.material.opacity = 1 - Math.exp(-depth);
    });
  }

  dim() {
    const tone = this.dark.matches ? "dark" : "light";
    const { extinction_pm } = this.told;
    this.scene.fog.color.set(FOG[tone]);
    this.scene.fog.density = extinction_pm;
    this.scene.background.set(SKY[tone]).lerp(this.scene.fog.color, 1 - Math.exp(-extinction_pm * SKY_M));
  }

  paintPuff() {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = PUFF_PX;
    const context = canvas.getContext("2d");
    const image = context.createImageData(PUFF_PX, PUFF_PX);
    for (let i = 0; i < PUFF_PX * PUFF_PX; ++i) {
      const away = (value) => ((value + 0.5) / PUFF_PX - 0.5) * 2 * SIGMAS;
      const square = away(i % PUFF_PX) ** 2 + away(Math.floor(i / PUFF_PX)) ** 2;
      image.data.set([255, 255, 255, 255 * Math.exp(-square / 2)], 4 * i);
    }
    context.putImageData(image, 0, 0);
    return new THREE.CanvasTexture(canvas);
  }

  words() {
    const { rain_mmph, snow_mmph, extinction_pm, dust } = this.told;
    const said = [];
    if (rain_mmph > 0) said.push(`rain ${rain_mmph.toPrecision(3)} mm/h`);
    if (snow_mmph > 0) said.push(`snow ${snow_mmph.toPrecision(3)} mm/h`);
    if (extinction_pm > 0) said.push(`visibility ${Math.round(CONTRAST / extinction_pm).toLocaleString("en")} m`);
    if (dust.length > 0) said.push(`${dust.length} puffs of dust`);
    return said.map((text) => `, ${text}`).join("");
  }
}
