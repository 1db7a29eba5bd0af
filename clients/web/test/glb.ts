/** Writes small head files, so that tests need no assets. */

type Numbers = Uint8Array | Int16Array | Uint16Array | Float32Array;

const COMPONENT = new Map<unknown, number>([[Uint8Array, 5121], [Int16Array, 5122], [Uint16Array, 5123], [Float32Array, 5126]]);
const KIND: Record<number, string> = { 1: "SCALAR", 2: "VEC2", 3: "VEC3" };

export class GlbWriter {
  readonly document: Record<"nodes" | "meshes" | "materials" | "accessors" | "bufferViews", unknown[]> & { asset: object; extras?: object } = {
    asset: { version: "2.0" },
    nodes: [], meshes: [], materials: [], accessors: [], bufferViews: [],
  };
  private readonly chunks: number[] = [];

  accessor(values: Numbers, width: number): number {
    const bytes = new Uint8Array(values.buffer);
    this.document.bufferViews.push({ buffer: 0, byteOffset: this.chunks.length, byteLength: bytes.length });
    this.chunks.push(...bytes);
    return this.document.accessors.push({
      bufferView: this.document.bufferViews.length - 1, type: KIND[width],
      componentType: COMPONENT.get(values.constructor), count: values.length / width,
    }) - 1;
  }

  part(name: string, positions: number[], triangles: number[], extra: object = {}): void {
    const primitive = {
      attributes: { POSITION: this.accessor(Float32Array.from(positions), 3) },
      indices: this.accessor(Uint16Array.from(triangles), 1),
    };
    this.document.meshes.push({ primitives: [primitive] });
    this.document.nodes.push({ name, mesh: this.document.meshes.length - 1, ...extra });
  }

  file(): Uint8Array {
    const json = new TextEncoder().encode(JSON.stringify(this.document));
    const head = new Uint8Array(json.length + (-json.length & 3)).fill(0x20);
    head.set(json);
    const total = 12 + 8 + head.length + 8 + this.chunks.length;
    const file = new Uint8Array(total);
    const view = new DataView(file.buffer);
    [0x46546c67, 2, total, head.length, 0x4e4f534a].forEach((word, i) => view.setUint32(4 * i, word, true));
    file.set(head, 20);
    view.setUint32(20 + head.length, this.chunks.length, true);
    view.setUint32(24 + head.length, 0x004e4942, true);
    file.set(this.chunks, 28 + head.length);
    return file;
  }
}

/** A folded sheet for a skin (the two halves share the edge 1-2 as split vertices), and triangles for the rest. */
export function smallHead(change: (writer: GlbWriter, extras: Record<string, unknown>) => void = () => undefined): Uint8Array {
  const writer = new GlbWriter();
  writer.part("skin", [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0], [0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7]);
  for (const name of ["eye_l", "eye_r", "teeth_upper", "teeth_lower", "tongue"]) {
    writer.part(name, [0, 0, 0, 1, 0, 0, 0, 1, 0], [0, 1, 2]);
  }
  const extras = {
    version: 1, name: "small", fapu: {}, fdp: {},
    mouth: { center: [0, 0, 0], size: [1, 1] }, camera: { target: [0, 0, 0], height: 2 },
    fat: [
      { fap: 3, part: "skin", knots: [-100, 200], scale: 0.001, indices: writer.accessor(Uint16Array.of(5, 6), 1),
        deltas: writer.accessor(Int16Array.of(0, 0, -100, 0, 0, -100, 0, 0, 1000, 0, 0, 1000), 3) },
      { fap: 4, part: "skin", knots: [100], scale: 0.01, indices: writer.accessor(Uint8Array.of(5), 1), deltas: writer.accessor(Int16Array.of(100, 0, 0), 3) },
    ],
    turns: [
      { faps: [23], axes: [[0, 2, 0]], parts: ["eye_l"], pivot: [0, 0, 0] },
      { faps: [48, 49], axes: [[1, 0, 0], [0, 1, 0]], parts: "*", pivot: [0, 0, 1],
        weights: { skin: writer.accessor(Uint8Array.of(0, 255, 255, 0, 255, 51, 0, 255), 1) } },
    ],
  };
  writer.document.extras = { fapstream: extras };
  change(writer, extras);
  return writer.file();
}
