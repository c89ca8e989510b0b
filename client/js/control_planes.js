// The volumes of a rig from its control planes, and the vertices in them: what
// a client computes for itself when it asks for CONTROL_PLANES.
//
// The bytes are described in core/gelenk/skin/control_plane_stream.h, the volumes
// in volume_rig.h and bezier_volume.h. World frame, m.

import {Encoding, FrameError, HEADER_BYTES, readHeader} from "./vertex_stream.js";

// center, s axis and t axis of a plane.
const PLANE_NUMBERS = 9;
const PLANE_BYTES = 4 * PLANE_NUMBERS;
// A volume is four planes, the coefficients of u^0 .. u^3.
const VOLUME_NUMBERS = 4 * PLANE_NUMBERS;
const VOLUMES_PER_LINK = 3;

/**
 * The volumes and vertices of one skin, as the layout of a stream has them.
 *
 * links: {parent, continuation, lengthM, startSpacingM, endSpacingM, isBranch}
 * each, parents first. The rest is packed, by vertex or by part: a part is what
 * a branch has of a vertex of its parent.
 */
export class LayeredSkin {
  #layout;
  #stubs = [];
  #planeCount;

  constructor(layout) {
    this.#layout = layout;
    const {links} = layout;
    links.forEach((link, i) => link.isBranch && this.#stubs.push(i));
    this.#planeCount = 4 * links.length + 2 * this.#stubs.length;
    this.#check();
  }

  get vertexCount() {
    return this.#layout.vertexVolumes.length;
  }

  // Volumes of links, then one a branch.
  get volumeCount() {
    return VOLUMES_PER_LINK * this.#layout.links.length + this.#stubs.length;
  }

  #check() {
    const {links, ...vertices} = this.#layout;
    links.forEach(({parent, continuation}, i) => {
      if (!(parent < i && continuation < links.length)) {
        throw new FrameError(`link ${i}: its neighbours are no links`);
      }
    });
    const count = vertices.vertexVolumes.length;
    const parts = vertices.partVertices.length;
    if (!vertices.partVertices.every((v, i, list) => v >= 0 && v < count &&
        (i === 0 || v >= list[i - 1]))) {
      throw new FrameError(
          `partVertices: want vertices 0 to ${count - 1}, rising`);
    }
    const wanted = {
      coordinates: 3 * count, normalComponents: 3 * count, partVolumes: parts,
      partCoordinates: 3 * parts, partShares: parts, partSlopes: 6 * parts,
      partShareSlopes: 2 * parts,
      ownSlopes: 6 * new Set(vertices.partVertices).size,
    };
    for (const [name, want] of Object.entries(wanted)) {
      if (vertices[name].length !== want) {
        throw new FrameError(
            `${name}: want ${want} numbers, got ${vertices[name].length}`);
      }
    }
    for (const volumes of [vertices.vertexVolumes, vertices.partVolumes]) {
      if (!volumes.every((v) => v >= 0 && v < this.volumeCount)) {
        throw new FrameError(`want volumes 0 to ${this.volumeCount - 1}`);
      }
    }
  }

  /**
   * @param {Uint8Array} bytes a CONTROL_PLANES frame
   * @returns {Float64Array} the volumes, VOLUME_NUMBERS each
   */
  volumesOf(bytes) {
    const header = readHeader(bytes);
    const size = this.#planeCount * PLANE_BYTES;
    if (header.encoding !== Encoding.CONTROL_PLANES ||
        header.blockCount !== this.#planeCount ||
        bytes.length - HEADER_BYTES !== size) {
      throw new FrameError(`want ${this.#planeCount} planes in ${
          size} bytes, got ${header.blockCount} in ${
          bytes.length - HEADER_BYTES}`);
    }
    const {planes, stubs} = this.#derivePlanes(bytes);
    const {links} = this.#layout;
    const volumes = new Float64Array(this.volumeCount * VOLUME_NUMBERS);
    const at = (volume) => volume * VOLUME_NUMBERS;
    links.forEach(({lengthM}, i) => {
      const own = planes[i];
      setBezier(own.slice(0, 4), volumes, at(VOLUMES_PER_LINK * i));
      setBezier(own.slice(3, 7), volumes, at(VOLUMES_PER_LINK * i + 1));
      setRigid(own, lengthM, volumes, at(VOLUMES_PER_LINK * i + 2));
    });
    stubs.forEach((stub, k) => setBezier(
        stub, volumes, at(VOLUMES_PER_LINK * links.length + k)));
    return volumes;
  }

  // P0 .. P6 of every link, and the four of every stub.
  #derivePlanes(bytes) {
    const floats = new Float32Array(bytes.slice(HEADER_BYTES).buffer);
    let next = 0;
    const take = () => floats.subarray(next, next += PLANE_NUMBERS);
    const {links} = this.#layout;
    const planes = links.map(() => {
      const own = [];
      for (const k of [1, 2, 4, 5]) own[k] = take();
      own[3] = middle(own[2], own[4]);
      return own;
    });
    const stubs = this.#stubs.map((link) => {
      const first = take();
      const third = take();
      const last = middle(third, planes[link][1]);
      planes[link][0] = last;
      return [first, shifted(first, links[link].startSpacingM), third, last];
    });
    links.forEach((link, i) => {
      const own = planes[i];
      if (link.parent < 0 && !link.isBranch) {
        own[0] = shifted(own[1], -link.startSpacingM);
      }
      if (link.continuation < 0) {
        own[6] = shifted(own[5], link.endSpacingM);
      } else {
        own[6] = middle(own[5], planes[link.continuation][1]);
        planes[link.continuation][0] = own[6];
      }
    });
    return {planes, stubs};
  }

  /**
   * Writes positions and unit normals, x y z a vertex.
   * @param {Float64Array} volumes of volumesOf
   * @param {Float32Array} positions
   * @param {Float32Array} normals
   */
  deform(volumes, positions, normals) {
    const {vertexVolumes, coordinates, normalComponents, partVertices} =
        this.#layout;
    const point = new Float64Array(12);
    let part = 0;
    let shared = 0;
    for (let v = 0; v < vertexVolumes.length; ++v) {
      evaluate(volumes, vertexVolumes[v], coordinates, 3 * v, point);
      const first = part;
      while (partVertices[part] === v) ++part;
      if (part > first) {
        this.#deformShared(
            volumes, point, {v, first, end: part, shared: shared++}, positions,
            normals);
        continue;
      }
      positions.set(point.subarray(0, 3), 3 * v);
      setUnit(normalOf(point, normalComponents, 3 * v), normals, 3 * v);
    }
  }

  // A vertex that parts first to end - 1 have a share of; `own` is where its
  // own volume has it.
  #deformShared(volumes, own, {v, first, end, shared}, positions, normals) {
    const {partVolumes, partCoordinates, partShares} = this.#layout;
    const {partSlopes, partShareSlopes, ownSlopes} = this.#layout;
    const point = new Float64Array(12);
    const moved = own.slice(0, 3);
    const tangents = [new Float64Array(3), new Float64Array(3)];
    let rest = 1;
    for (let part = first; part < end; ++part) {
      evaluate(volumes, partVolumes[part], partCoordinates, 3 * part, point);
      const share = partShares[part];
      rest -= share;
      for (let c = 0; c < 3; ++c) {
        const way = point[c] - own[c];
        moved[c] += share * way;
        tangents.forEach((tangent, k) => {
          tangent[c] += share * along(point, partSlopes, 6 * part + 3 * k, c) +
              partShareSlopes[2 * part + k] * way;
        });
      }
    }
    tangents.forEach((tangent, k) => {
      for (let c = 0; c < 3; ++c) {
        tangent[c] += rest * along(own, ownSlopes, 6 * shared + 3 * k, c);
      }
    });
    positions.set(moved, 3 * v);
    setUnit(cross(tangents[0], 0, tangents[1], 0), normals, 3 * v);
  }
}

function middle(a, b) {
  return Float64Array.from(a, (number, i) => (number + b[i]) / 2);
}

// The same plane farther along its normal.
function shifted(plane, distance) {
  const moved = Float64Array.from(plane);
  const normal = cross(plane, 3, plane, 6);
  const length = Math.hypot(...normal);
  for (let c = 0; c < 3; ++c) moved[c] += distance * normal[c] / length;
  return moved;
}

function cross(a, i, b, j) {
  return [
    a[i + 1] * b[j + 2] - a[i + 2] * b[j + 1],
    a[i + 2] * b[j] - a[i] * b[j + 2],
    a[i] * b[j + 1] - a[i + 1] * b[j],
  ];
}

// The cubic between four planes, in the power basis.
function setBezier([p0, p1, p2, p3], volumes, at) {
  for (let i = 0; i < PLANE_NUMBERS; ++i) {
    volumes[at + i] = p0[i];
    volumes[at + PLANE_NUMBERS + i] = 3 * (p1[i] - p0[i]);
    volumes[at + 2 * PLANE_NUMBERS + i] = 3 * (p0[i] - 2 * p1[i] + p2[i]);
    volumes[at + 3 * PLANE_NUMBERS + i] = p3[i] - p0[i] + 3 * (p1[i] - p2[i]);
  }
}

// What moves with the link as one piece. Muscles scale the axes of P2 but do
// not turn them.
function setRigid(planes, length, volumes, at) {
  const axes = [planes[2].slice(3, 6), planes[2].slice(6, 9)].map((axis) => {
    const size = Math.hypot(...axis);
    return axis.map((number) => number / size);
  });
  const along = cross(axes[0], 0, axes[1], 0);
  for (let c = 0; c < 3; ++c) {
    volumes[at + c] = planes[0][c];
    volumes[at + 3 + c] = axes[0][c];
    volumes[at + 6 + c] = axes[1][c];
    volumes[at + PLANE_NUMBERS + c] = length * along[c];
  }
}

// F and its derivatives by u, s and t, x y z each, at coordinates u s t.
function evaluate(volumes, volume, coordinates, first, point) {
  const u = coordinates[first];
  const s = coordinates[first + 1];
  const t = coordinates[first + 2];
  const at = volume * VOLUME_NUMBERS;
  const value = (i) => volumes[at + i] + u * (volumes[at + 9 + i] +
      u * (volumes[at + 18 + i] + u * volumes[at + 27 + i]));
  const slope = (i) => volumes[at + 9 + i] +
      u * (2 * volumes[at + 18 + i] + 3 * u * volumes[at + 27 + i]);
  for (let c = 0; c < 3; ++c) {
    const a = value(3 + c);
    const b = value(6 + c);
    point[c] = value(c) + s * a + t * b;
    point[3 + c] = slope(c) + s * slope(3 + c) + t * slope(6 + c);
    point[6 + c] = a;
    point[9 + c] = b;
  }
}

// Coordinate c of the way along the slopes of u, s and t.
function along(point, slopes, first, c) {
  return slopes[first] * point[3 + c] + slopes[first + 1] * point[6 + c] +
      slopes[first + 2] * point[9 + c];
}

// n = nu_u (a x b) + F_u x (nu_t a - nu_s b).
function normalOf(point, components, first) {
  const [nuU, nuS, nuT] = components.slice(first, first + 3);
  const across = cross(point, 6, point, 9);
  const tilt = [6, 7, 8].map((i) => nuT * point[i] - nuS * point[i + 3]);
  const turned = cross(point, 3, tilt, 0);
  return across.map((number, c) => nuU * number + turned[c]);
}

function setUnit(vector, normals, first) {
  const length = Math.hypot(...vector) || 1;
  for (let c = 0; c < 3; ++c) normals[first + c] = vector[c] / length;
}
