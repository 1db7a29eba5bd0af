/** How large an encoded picture is, read from its first bytes: so that nobody decodes a bomb. PNG, JPEG, WebP. */

/** Width and height in pixels; null where that cannot be told. */
export function pictureSize(data: Uint8Array): [number, number] | null {
  const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
  const starts = (at: number, ...bytes: number[]) => data.length > at + bytes.length && bytes.every((byte, i) => data[at + i] === byte);
  if (starts(0, 0x89, 0x50, 0x4e, 0x47) && data.length >= 24) return [view.getUint32(16), view.getUint32(20)];
  if (starts(0, 0xff, 0xd8)) return jpeg(data, view);
  if (starts(0, 0x52, 0x49, 0x46, 0x46) && starts(8, 0x57, 0x45, 0x42, 0x50) && data.length >= 30) return webp(view);
  return null;
}

function jpeg(data: Uint8Array, view: DataView): [number, number] | null {
  for (let at = 2; at + 9 <= data.length && data[at] === 0xff; ) {
    const marker = data[at + 1];
    if (marker >= 0xc0 && marker <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(marker)) return [view.getUint16(at + 7), view.getUint16(at + 5)];
    at += marker === 0xff ? 1 : 2 + view.getUint16(at + 2);
  }
  return null;
}

function webp(view: DataView): [number, number] | null {
  const three = (at: number) => view.getUint16(at, true) + (view.getUint8(at + 2) << 16) + 1;
  switch (view.getUint32(12)) {
    case 0x56503820: return [view.getUint16(26, true) & 0x3fff, view.getUint16(28, true) & 0x3fff];
    case 0x5650384c: return [(view.getUint32(21, true) & 0x3fff) + 1, ((view.getUint32(21, true) >>> 14) & 0x3fff) + 1];
    case 0x56503858: return [three(24), three(27)];
    default: return null;
  }
}
