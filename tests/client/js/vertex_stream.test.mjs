// The decoders against frames that the C++ encoders wrote.

import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {test} from "node:test";

import {
  DeltaDecoder, FrameError, KeyframeNeeded, decodeFloats, decodeQuantized,
  readHeader, unpackVertices,
} from "../../../client/js/vertex_stream.js";

const vectors = JSON.parse(readFileSync(
    new URL("../../golden/skin_stream.json", import.meta.url)));

// At an odd address, as views into messages are.
function bytesOf(base64) {
  const bytes = Buffer.from(base64, "base64");
  const odd = new Uint8Array(bytes.length + 1).subarray(1);
  odd.set(bytes);
  return odd;
}

function assertClose(got, want, tolerance) {
  assert.equal(got.length, want.length);
  got.forEach((number, i) => assert.ok(
      Math.abs(number - want[i]) <= tolerance,
      `${i}: ${number} against ${want[i]}`));
}

const room = () => new Float32Array(3 * vectors.slots.length);
const deltas = vectors.delta.map(({bytes}) => bytesOf(bytes));

test("floats are what was written", () => {
  const [positions, normals] = [room(), room()];
  decodeFloats(
      bytesOf(vectors.float32.bytes), vectors.slots, positions, normals);
  assertClose(positions, vectors.float32.positions, 0);
  assertClose(normals, vectors.float32.normals, 0);
});

test("quantised vertices are what was written", () => {
  const [positions, normals] = [room(), room()];
  const frame = decodeQuantized(bytesOf(vectors.quantized.bytes));
  unpackVertices(frame, vectors.slots, positions, normals);
  assertClose(positions, vectors.quantized.positions, 1e-6);
  assertClose(normals, vectors.quantized.normals, 1e-6);
});

test("differences are what was written, byte by byte", () => {
  const decoder = new DeltaDecoder();
  vectors.delta.forEach(({isKeyframe, blocks}, i) => {
    const frame = decoder.decode(deltas[i]);
    assert.equal(frame.header.isKeyframe, isKeyframe);
    assert.equal(frame.header.frameNumber, i);
    assert.deepEqual(Buffer.from(frame.blocks), Buffer.from(blocks, "base64"));
  });
});

test("a lost frame is noticed and heals at the next keyframe", () => {
  const isKeyframe = vectors.delta.map((frame) => frame.isKeyframe);
  for (let lost = 0; lost < deltas.length; ++lost) {
    const decoder = new DeltaDecoder();
    let heals = isKeyframe.indexOf(true, lost + 1);
    if (heals < 0) heals = deltas.length;
    for (let i = 0; i < deltas.length; ++i) {
      if (i === lost) continue;
      if (i > lost && i < heals) {
        assert.throws(() => decoder.decode(deltas[i]), KeyframeNeeded);
      } else {
        assert.deepEqual(
            Buffer.from(decoder.decode(deltas[i]).blocks),
            Buffer.from(vectors.delta[i].blocks, "base64"));
      }
    }
  }
});

test("what is cut off is refused", () => {
  for (const bytes of [deltas[0], deltas[1]]) {
    for (let size = 0; size < bytes.length; ++size) {
      const decoder = new DeltaDecoder();
      if (bytes === deltas[1]) decoder.decode(deltas[0]);
      assert.throws(() => decoder.decode(bytes.subarray(0, size)), FrameError);
    }
  }
  for (const {bytes} of [vectors.float32, vectors.quantized]) {
    const whole = bytesOf(bytes);
    const cut = whole.subarray(0, whole.length - 1);
    assert.throws(
        () => decodeFloats(cut, vectors.slots, room(), room()), FrameError);
    assert.throws(() => decodeQuantized(cut), FrameError);
  }
});

// Any byte changed: other vertices or an error of ours, nothing else.
test("noise is harmless", () => {
  let state = 1;
  const random = (count) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor(state / 2 ** 32 * count);
  };
  for (let repeat = 0; repeat < 3000; ++repeat) {
    const bytes = deltas[0].slice();
    for (let k = random(4); k >= 0; --k) bytes[random(bytes.length)] = random(256);
    try {
      const frame = new DeltaDecoder().decode(bytes);
      unpackVertices(frame, [0], new Float32Array(3), new Float32Array(3));
    } catch (error) {
      assert.ok(error instanceof FrameError || error instanceof KeyframeNeeded,
                String(error));
    }
  }
});

test("headers say what is wrong", () => {
  const bytes = deltas[0];
  const changed = (at, value) => {
    const copy = bytes.slice();
    copy[at] = value;
    return copy;
  };
  assert.throws(() => readHeader(changed(0, 88)), /GSK1/);
  assert.throws(() => readHeader(changed(4, 9)), /unknown encoding 9/);
  assert.throws(() => readHeader(changed(15, 9)), /want at most 131072/);
  assert.throws(() => readHeader(changed(47, 0xff)), /box/);
  assert.throws(() => readHeader(bytes.subarray(0, 4)), /got 4/);
  assert.throws(() => decodeQuantized(bytes), /has encoding 3, want 2/);
  const frame = decodeQuantized(bytesOf(vectors.quantized.bytes));
  assert.throws(
      () => unpackVertices(
          frame, [16 * frame.header.blockCount], room(), room()),
      /slot/);
});
