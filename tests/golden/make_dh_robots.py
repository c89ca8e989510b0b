#!/usr/bin/env python3
"""Numbers of tests/golden/dh_robots.h: two arms by products of 4 x 4 matrices.

Plain Python; the library goes by quaternions. Panda: its maker's modified
table. UR5: its maker's standard table. Run: python3 make_dh_robots.py >
dh_robots.h
"""
from math import cos, pi, sin

# a, alpha, d, theta
PANDA = [(0, 0, 0.333, 0), (0, -pi / 2, 0, 0), (0, pi / 2, 0.316, 0),
         (0.0825, pi / 2, 0, 0), (-0.0825, -pi / 2, 0.384, 0),
         (0, pi / 2, 0, 0), (0.088, pi / 2, 0, 0)]
UR5 = [(0, pi / 2, 0.089159, 0), (-0.425, 0, 0, 0), (-0.39225, 0, 0, 0),
       (0, pi / 2, 0.10915, 0), (0, -pi / 2, 0.09465, 0), (0, 0, 0.0823, 0)]
PANDA_POSE = [0.3, -0.5, 0.2, -1.9, 0.4, 1.7, 0.6]
UR5_POSE = [0.7, -1.1, 1.3, -0.4, 0.9, 0.2]


def times(a, b):
    return [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)]
            for r in range(4)]


def modified(a, alpha, d, t):
    ca, sa, ct, st = cos(alpha), sin(alpha), cos(t), sin(t)
    return [[ct, -st, 0, a], [st * ca, ct * ca, -sa, -sa * d],
            [st * sa, ct * sa, ca, ca * d], [0, 0, 0, 1]]


def standard(a, alpha, d, t):
    ca, sa, ct, st = cos(alpha), sin(alpha), cos(t), sin(t)
    return [[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st],
            [0, sa, ca, d], [0, 0, 0, 1]]


def chain(rows, pose, step):
    out = [[float(r == c) for c in range(4)] for r in range(4)]
    for (a, alpha, d, theta), q in zip(rows, pose):
        out = times(out, step(a, alpha, d, theta + q))
    return out


def text(numbers):
    return "{" + ", ".join(repr(float(x)) for x in numbers) + "}"


def show(name, rows, pose, tip):
    print("// a, alpha, d, theta")
    print("inline constexpr double k%sRows[][4] = {" % name)
    for row in rows:
        print("  %s," % text(row))
    print("};")
    print("inline constexpr double k%sPose[] = %s;" % (name, text(pose)))
    flat = [x for row in tip[:3] for x in row]
    print("// Rows of the tip's 3 x 4 matrix.")
    print("inline constexpr double k%sTip[12] = %s;\n" % (name, text(flat)))


def main():
    print("// Written by make_dh_robots.py, which says how.")
    print("#ifndef GELENK_TESTS_GOLDEN_DH_ROBOTS_H_")
    print("#define GELENK_TESTS_GOLDEN_DH_ROBOTS_H_\n")
    print("// clang-format off\nnamespace gelenk::golden {\n")
    print("inline constexpr double kPandaFlange = 0.107;")
    flange = standard(0, 0, 0.107, 0)
    show("Panda", PANDA, PANDA_POSE,
         times(chain(PANDA, PANDA_POSE, modified), flange))
    show("Ur5", UR5, UR5_POSE, chain(UR5, UR5_POSE, standard))
    print("}  // namespace gelenk::golden\n// clang-format on\n")
    print("#endif  // GELENK_TESTS_GOLDEN_DH_ROBOTS_H_")


main()
