// Reads CDR messages (little-endian) after their definition in ROS 2's words, which the channel brings
// along (protocols/foxglove/cdr_messages.h).

const SIZES = { uint8: 1, int32: 4, uint32: 4, uint64: 8, float64: 8 };

// name of the type -> [{type, isList, name}]; the message itself is "".
function definitions(text) {
  const all = new Map();
  for (const part of text.split(/^=+\n/m)) {
    const lines = part.split("\n").filter(Boolean);
    const head = lines[0].startsWith("MSG: ") ? lines.shift().slice(5) : "";
    all.set(head, lines.map((line) => {
      const [type, name] = line.split(" ");
      return { type: type.replace("[]", ""), isList: type.endsWith("[]"), name };
    }));
  }
  return all;
}

// What makes an object of the bytes of a message. A list of uint8 is a view of them.
export function cdrReader(schema) {
  const types = definitions(schema);
  return (bytes) => {
    const view = new DataView(bytes.buffer, bytes.byteOffset + 4, bytes.byteLength - 4);
    const text = new TextDecoder();
    let at = 0;
    const number = (type) => {
      const size = SIZES[type];
      at += (size - (at % size)) % size;
      at += size;
      switch (type) {
        case "uint8": return view.getUint8(at - size);
        case "int32": return view.getInt32(at - size, true);
        case "uint32": return view.getUint32(at - size, true);
        case "uint64": return view.getBigUint64(at - size, true);
        default: return view.getFloat64(at - size, true);
      }
    };
    const take = (size) => {
      at += size;
      return new Uint8Array(view.buffer, view.byteOffset + at - size, size);
    };
    const one = (type) => {
      if (type in SIZES) return number(type);
      if (type === "string") return text.decode(take(number("uint32")).subarray(0, -1));
      return object(type);
    };
    const list = (type) => {
      const count = number("uint32");
      return type === "uint8" ? take(count) : Array.from({ length: count }, () => one(type));
    };
    const object = (type) =>
      Object.fromEntries(types.get(type).map(({ type: of, isList, name }) => [name, isList ? list(of) : one(of)]));
    return object("");
  };
}
