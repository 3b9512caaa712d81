// Numbers of the page, as src/page/pack.rs writes them.
const Unpack = (function () {
  'use strict';
  const text = atob(document.getElementById('bytes').textContent.trim());
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);

  // The bytes of a chunk, inflated.
  async function chunk(at) {
    const packed = bytes.subarray(at[0], at[0] + at[1]);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // Reads arrays of whole numbers off a chunk, one after the other.
  function reader(raw) {
    let at = 0;
    return function (count, components, width) {
      const out = new Int32Array(count * components);
      const shift = 32 - 8 * width;
      for (let c = 0; c < components; c++) {
        let sum = 0;
        for (let i = 0; i < count; i++) {
          let difference = 0;
          for (let k = 0; k < width; k++) difference |= raw[at + k * count + i] << (8 * k);
          sum = (sum + difference) | 0;
          // Differences are modulo the range of their bytes.
          sum = (sum << shift) >> shift;
          out[i * components + c] = sum;
        }
        at += width * count;
      }
      return out;
    };
  }
  return { chunk: chunk, reader: reader };
}());
