// Volumes and vertices against what the server computes from the same planes.

import assert from "node:assert/strict";
import {readFileSync} from "node:fs";
import {test} from "node:test";

import {LayeredSkin} from "../../../client/js/control_planes.js";
import {FrameError} from "../../../client/js/vertex_stream.js";

const {layout, frames} = JSON.parse(readFileSync(
    new URL("../../golden/skin_stream.json", import.meta.url))).controlPlanes;
const bytesOf = (base64) => new Uint8Array(Buffer.from(base64, "base64"));

// Planes and coordinates are floats of up to 2 m.
const FLOAT_TOLERANCE = 2e-6;
// Of unit vectors from floats that partly cancel.
const NORMAL_TOLERANCE = 1e-4;

test("vertices are where the server has them", () => {
  const skin = new LayeredSkin(layout);
  const shared = new Set(layout.partVertices);
  assert.ok(shared.size > 20 && shared.size < skin.vertexCount);
  for (const frame of frames) {
    const positions = new Float32Array(3 * skin.vertexCount);
    const normals = new Float32Array(3 * skin.vertexCount);
    skin.deform(skin.volumesOf(bytesOf(frame.bytes)), positions, normals);
    for (let i = 0; i < positions.length; ++i) {
      const name = `vertex ${Math.floor(i / 3)}`;
      assert.ok(
          Math.abs(positions[i] - frame.positions[i]) < FLOAT_TOLERANCE,
          `${name}: ${positions[i]}, want ${frame.positions[i]}`);
      assert.ok(
          Math.abs(normals[i] - frame.normals[i]) < NORMAL_TOLERANCE,
          `normal of ${name}: ${normals[i]}, want ${frame.normals[i]}`);
    }
  }
});

test("frames of another rig are refused", () => {
  const skin = new LayeredSkin(layout);
  const bytes = bytesOf(frames[0].bytes);
  for (let size = 0; size < bytes.length; size += 7) {
    assert.throws(() => skin.volumesOf(bytes.subarray(0, size)), FrameError);
  }
  const other = new LayeredSkin({...layout, links: layout.links.map(
      (link) => ({...link, isBranch: false})),
      vertexVolumes: [], coordinates: [], normalComponents: [],
      partVertices: [], partVolumes: [], partCoordinates: [], partShares: [],
      partSlopes: [], partShareSlopes: [], ownSlopes: []});
  assert.throws(() => other.volumesOf(bytes), /planes/);
});

test("layouts are checked", () => {
  const bad = [
    [{coordinates: layout.coordinates.slice(1)}, /coordinates: want/],
    [{vertexVolumes: layout.vertexVolumes.map(() => 9999)}, /want volumes/],
    [{partVertices: layout.partVertices.map(() => -1)}, /partVertices/],
    [{partVertices: [...layout.partVertices].reverse()}, /rising/],
    [{ownSlopes: layout.ownSlopes.slice(6)}, /ownSlopes: want/],
    [{links: layout.links.map((link) => ({...link, continuation: 999}))},
     /no links/],
  ];
  for (const [change, words] of bad) {
    assert.throws(() => new LayeredSkin({...layout, ...change}), words);
  }
});
