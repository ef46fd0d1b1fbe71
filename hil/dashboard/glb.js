// Reads the binary glTF that a run serves (protocols/gltf/glb.h): triangles of one colour, or with
// colours of their vertices. Nothing else of the format.

const COMPONENTS = { 5121: Uint8Array, 5125: Uint32Array, 5126: Float32Array };
const SIZES = { SCALAR: 1, VEC3: 3, VEC4: 4 };
const HEADER = 12;
const CHUNK_HEADER = 8;

// [{positions, indices, colours?, colour: [red, green, blue]}] in linear light.
export function readGlb(buffer) {
  if (buffer.byteLength === 0) return [];
  const view = new DataView(buffer);
  const jsonSize = view.getUint32(HEADER, true);
  const json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, HEADER + CHUNK_HEADER, jsonSize)));
  const binary = HEADER + CHUNK_HEADER + jsonSize + CHUNK_HEADER;
  const read = (index) => {
    const accessor = json.accessors[index];
    const from = binary + json.bufferViews[accessor.bufferView].byteOffset;
    return new COMPONENTS[accessor.componentType](buffer, from, accessor.count * SIZES[accessor.type]);
  };
  return json.meshes[0].primitives.map((primitive) => ({
    positions: read(primitive.attributes.POSITION),
    indices: read(primitive.indices),
    colours: "COLOR_0" in primitive.attributes ? read(primitive.attributes.COLOR_0) : null,
    colour: json.materials[primitive.material].pbrMetallicRoughness.baseColorFactor.slice(0, 3),
  }));
}
