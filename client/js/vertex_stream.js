// Frames of a skin as gelenk sends them: floats, quantised, differences.
//
// The bytes are described in core/gelenk/skin/vertex_stream.h and packed_row.h.
// Positions are in world frame, m; normals are unit. Runs in browsers and Node;
// needs nothing else.
//
//   const decoder = new DeltaDecoder();
//   try {
//     unpackVertices(decoder.decode(frame), slots, positions, normals);
//   } catch (error) {
//     if (!(error instanceof KeyframeNeeded)) throw error;  // else wait for one
//   }
//
// `slots` says where in a frame each vertex is; the layout of a stream has it.
// Bytes may come from anybody: what is malformed throws a FrameError.

export const Encoding = Object.freeze({
  FLOAT32: 1,
  QUANTIZED: 2,
  DELTA: 3,
  CONTROL_PLANES: 4,
});

export const HEADER_BYTES = 48;
// Vertices of a block; rows of a block are that long.
export const LANES = 16;
const MAX_BLOCKS = 1 << 17;
const FLOAT_BLOCK_BYTES = 6 * 4 * LANES;
const QUANTIZED_BLOCK_BYTES = 3 * 2 * LANES + 2 * LANES;
const POSITION_ROWS = 3;
const ROWS = 5;

/** A frame that is malformed. */
export class FrameError extends Error {
  name = "FrameError";
}

/** A frame that builds on one that was not decoded. */
export class KeyframeNeeded extends Error {
  name = "KeyframeNeeded";
}

/**
 * @param {Uint8Array} bytes
 * @returns {{encoding: number, isKeyframe: boolean, frameNumber: number,
 *            blockCount: number, box: {origin: number[], size: number}}}
 */
export function readHeader(bytes) {
  if (bytes.length < HEADER_BYTES) {
    throw new FrameError(
        `want at least ${HEADER_BYTES} bytes, got ${bytes.length}`);
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length);
  if (view.getUint32(0) !== 0x47534b31) {
    throw new FrameError("does not begin with GSK1");
  }
  const header = {
    encoding: view.getUint8(4),
    isKeyframe: view.getUint8(5) !== 0,
    frameNumber: view.getUint32(8, true),
    blockCount: view.getUint32(12, true),
    box: {
      origin: [16, 24, 32].map((at) => view.getFloat64(at, true)),
      size: view.getFloat64(40, true),
    },
  };
  if (header.encoding < 1 || header.encoding > 4) {
    throw new FrameError(`unknown encoding ${header.encoding}`);
  }
  if (header.blockCount > MAX_BLOCKS) {
    throw new FrameError(
        `want at most ${MAX_BLOCKS} blocks, got ${header.blockCount}`);
  }
  if (!header.box.origin.every(Number.isFinite) ||
      !(header.box.size > 0 && header.box.size < Infinity)) {
    throw new FrameError("the box is malformed");
  }
  return header;
}

// The header of a frame that must have that encoding.
function expectHeader(bytes, encoding) {
  const header = readHeader(bytes);
  if (header.encoding !== encoding) {
    throw new FrameError(
        `has encoding ${header.encoding}, want ${encoding}`);
  }
  return header;
}

// What follows the header, in memory of its own, so that it is aligned.
function bodyOf(bytes, header, blockBytes) {
  const want = header.blockCount * blockBytes;
  if (bytes.length - HEADER_BYTES !== want) {
    throw new FrameError(`${header.blockCount} blocks are ${want} bytes, got ${
        bytes.length - HEADER_BYTES}`);
  }
  return bytes.slice(HEADER_BYTES);
}

/**
 * Writes positions and normals of a FLOAT32 frame, x y z a vertex.
 * @param {Uint8Array} bytes
 * @param {ArrayLike<number>} slots one a vertex
 * @param {Float32Array} positions
 * @param {Float32Array} normals
 * @returns its header
 */
export function decodeFloats(bytes, slots, positions, normals) {
  const header = expectHeader(bytes, Encoding.FLOAT32);
  const body = bodyOf(bytes, header, FLOAT_BLOCK_BYTES);
  checkSlots(slots, header.blockCount);
  const floats = new Float32Array(body.buffer);
  for (let v = 0; v < slots.length; ++v) {
    const at = 6 * LANES * (slots[v] >> 4) + slots[v] % LANES;
    for (let k = 0; k < 3; ++k) {
      positions[3 * v + k] = floats[at + k * LANES];
      normals[3 * v + k] = floats[at + (3 + k) * LANES];
    }
  }
  return header;
}

/**
 * A QUANTIZED frame as it is, for unpackVertices.
 * @param {Uint8Array} bytes
 * @returns {{header: object, blocks: Uint8Array}}
 */
export function decodeQuantized(bytes) {
  const header = expectHeader(bytes, Encoding.QUANTIZED);
  return {header, blocks: bodyOf(bytes, header, QUANTIZED_BLOCK_BYTES)};
}

/** One stream's DELTA frames. */
export class DeltaDecoder {
  // Number of the last frame, and how many of `#last` and `#before` are frames
  // of the same run.
  #frameNumber = 0;
  #knownFrames = 0;
  #last = new Uint8Array(0);
  #before = new Uint8Array(0);

  /**
   * @param {Uint8Array} bytes
   * @returns {{header: object, blocks: Uint8Array}} for unpackVertices; good
   *     until two frames later.
   * @throws {KeyframeNeeded} when a frame was lost; the next keyframe mends it.
   */
  decode(bytes) {
    const known = this.#knownFrames;
    this.#knownFrames = 0;
    const header = expectHeader(bytes, Encoding.DELTA);
    const size = header.blockCount * QUANTIZED_BLOCK_BYTES;
    const isNext = known > 0 &&
        header.frameNumber === ((this.#frameNumber + 1) >>> 0) &&
        size === this.#last.length;
    if (!header.isKeyframe && !isNext) {
      throw new KeyframeNeeded(
          `frame ${header.frameNumber} builds on one that is not here`);
    }
    const rows = new PackedRows(bytes, HEADER_BYTES);
    if (rows.bytesLeft < header.blockCount * ROWS) {
      throw new FrameError("ends too early");
    }
    // The one before the last makes room.
    const blocks =
        this.#before.length === size ? this.#before : new Uint8Array(size);
    this.#predict(header.isKeyframe ? 0 : known, blocks);
    const words = new Uint16Array(blocks.buffer);
    const row = new Uint16Array(LANES);
    for (let block = 0; block < header.blockCount; ++block) {
      const at = block * QUANTIZED_BLOCK_BYTES;
      for (let k = 0; k < POSITION_ROWS; ++k) {
        rows.take(16, row);
        const first = at / 2 + k * LANES;
        for (let i = 0; i < LANES; ++i) words[first + i] += row[i];
      }
      for (let k = POSITION_ROWS; k < ROWS; ++k) {
        rows.take(8, row);
        const first = at + (POSITION_ROWS + k) * LANES;
        for (let i = 0; i < LANES; ++i) blocks[first + i] += row[i];
      }
    }
    if (rows.bytesLeft !== 0) {
      throw new FrameError("goes on behind its last block");
    }
    this.#before = this.#last;
    this.#last = blocks;
    this.#frameNumber = header.frameNumber;
    this.#knownFrames = header.isKeyframe ? 1 : 2;
    return {header, blocks};
  }

  // What `known` frames before say, into `blocks`, which may be the one before
  // the last.
  #predict(known, blocks) {
    if (known === 0) {
      blocks.fill(0);
      return;
    }
    if (known === 1) {
      blocks.set(this.#last);
      return;
    }
    const last = new Uint16Array(this.#last.buffer);
    const words = new Uint16Array(blocks.buffer);
    const blockWords = QUANTIZED_BLOCK_BYTES / 2;
    for (let first = 0; first < words.length; first += blockWords) {
      const normals = first + POSITION_ROWS * LANES;
      for (let i = first; i < normals; ++i) words[i] = 2 * last[i] - words[i];
      for (let i = normals; i < first + blockWords; ++i) words[i] = last[i];
    }
  }
}

// Takes packed rows from bytes, one after the other.
class PackedRows {
  constructor(bytes, at) {
    this.bytes = bytes;
    this.at = at;
  }

  get bytesLeft() {
    return this.bytes.length - this.at;
  }

  // Sixteen numbers modulo 2^numberBits.
  take(numberBits, row) {
    if (this.bytesLeft < 1) throw new FrameError("ends too early");
    const {bytes} = this;
    const head = bytes[this.at];
    const width = head & 0x1f;
    const exceptions = head >> 6;
    if (width > numberBits || this.bytesLeft < 1 + 2 * (width + exceptions)) {
      throw new FrameError("a row is malformed");
    }
    let next = this.at + 1;
    let pending = 0;
    let pendingBits = 0;
    const mask = (1 << width) - 1;
    for (let i = 0; i < LANES; ++i) {
      for (; pendingBits < width; pendingBits += 8) {
        pending |= bytes[next++] << pendingBits;
      }
      row[i] = pending & mask;
      pending >>>= width;
      pendingBits -= width;
    }
    let lastLane = -1;
    for (let k = 0; k < exceptions; ++k, next += 2) {
      const exception = bytes[next] | (bytes[next + 1] << 8);
      const lane = exception % LANES;
      const number = ((exception >> 4) << width) | row[lane];
      if (lane <= lastLane || number >> numberBits !== 0) {
        throw new FrameError("an exception is malformed");
      }
      lastLane = lane;
      row[lane] = number;
    }
    const isLateral = (head & 0x20) !== 0;
    for (let i = 0; i < LANES; ++i) {
      row[i] = (row[i] >> 1) ^ -(row[i] & 1);
      if (isLateral && i > 0) row[i] += row[i - 1];
    }
    this.at = next;
  }
}

/**
 * Writes positions and normals of a quantised frame, x y z a vertex.
 * @param {{header: object, blocks: Uint8Array}} frame
 * @param {ArrayLike<number>} slots one a vertex
 * @param {Float32Array} positions
 * @param {Float32Array} normals
 */
export function unpackVertices({header, blocks}, slots, positions, normals) {
  checkSlots(slots, header.blockCount);
  const words = new Uint16Array(blocks.buffer);
  const bytes = new Int8Array(blocks.buffer);
  const {origin, size} = header.box;
  const step = size / 65535;
  const normal = [0, 0, 0];
  for (let v = 0; v < slots.length; ++v) {
    const block = slots[v] >> 4;
    const lane = slots[v] % LANES;
    const word = block * QUANTIZED_BLOCK_BYTES / 2 + lane;
    for (let k = 0; k < 3; ++k) {
      positions[3 * v + k] = origin[k] + step * words[word + k * LANES];
    }
    const byte =
        block * QUANTIZED_BLOCK_BYTES + 2 * POSITION_ROWS * LANES + lane;
    fromOctahedral(bytes[byte], bytes[byte + LANES], normal);
    normals.set(normal, 3 * v);
  }
}

/** The unit vector of an octahedral code of 8 + 8 bits, into `out`. */
export function fromOctahedral(codeX, codeY, out) {
  let x = codeX / 127;
  let y = codeY / 127;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) {
    const foldedX = 1 - Math.abs(y);
    const foldedY = 1 - Math.abs(x);
    x = x < 0 ? -foldedX : foldedX;
    y = y < 0 ? -foldedY : foldedY;
  }
  const length = Math.hypot(x, y, z);
  out[0] = x / length;
  out[1] = y / length;
  out[2] = z / length;
}

function checkSlots(slots, blockCount) {
  for (let v = 0; v < slots.length; ++v) {
    if (!(slots[v] >= 0 && slots[v] < LANES * blockCount)) {
      throw new FrameError(`vertex ${v}: slot ${slots[v]} is not in a frame of ${
          blockCount} blocks`);
    }
  }
}
