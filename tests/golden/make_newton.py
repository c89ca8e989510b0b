#!/usr/bin/env python3
"""Numbers of tests/golden/newton.h, by another way than the library's.

Plain Python. The Jacobian of the planar chain is written out by hand, J^+ is
J^T (J J^T)^-1 with the 2 x 2 inverse in closed form (the library uses singular
values). The smallest change comes from Lagrange's conditions, q - q_old = J^T m
and g = 0, solved by Newton on all five unknowns with a numeric derivative (the
library iterates in the null space). The square example, two links, is checked
against its closed form. Run: python3 make_newton.py > newton.h
"""
import math

BASE, LENGTHS = (50.0, 400.0), (150.0, 200.0, 100.0)
START, TARGET = (0.6, 1.0, -0.7), (350.0, 700.0)


def tip(q, lengths=LENGTHS, base=BASE):
    x, y, a = base[0], base[1], 0.0
    for length, angle in zip(lengths, q):
        a += angle
        x += length * math.cos(a)
        y += length * math.sin(a)
    return x, y


def jacobian(q, lengths=LENGTHS):
    rows = [[0.0] * len(q), [0.0] * len(q)]
    a = 0.0
    for i, angle in enumerate(q):
        a += angle
        for k in range(i + 1):
            rows[0][k] -= lengths[i] * math.sin(a)
            rows[1][k] += lengths[i] * math.cos(a)
    return rows


def pseudo_inverse(j):
    a = sum(x * x for x in j[0])
    b = sum(x * y for x, y in zip(*j))
    d = sum(y * y for y in j[1])
    det = a * d - b * b
    return [[(d * x - b * y) / det, (a * y - b * x) / det]
            for x, y in zip(*j)]


def solve(matrix, right):
    n = len(right)
    m = [row[:] + [r] for row, r in zip(matrix, right)]
    for c in range(n):
        p = max(range(c, n), key=lambda r: abs(m[r][c]))
        m[c], m[p] = m[p], m[c]
        for r in range(n):
            if r != c:
                f = m[r][c] / m[c][c]
                m[r] = [x - f * y for x, y in zip(m[r], m[c])]
    return [m[i][n] / m[i][i] for i in range(n)]


def iterates(count):
    q, out = list(START), []
    for _ in range(count):
        g = [f - x for f, x in zip(tip(q), TARGET)]
        out.append((q, math.hypot(*g)))
        p = pseudo_inverse(jacobian(q))
        q = [a - r[0] * g[0] - r[1] * g[1] for a, r in zip(q, p)]
    return out


def smallest_change(q):
    def conditions(z):
        q, m = z[:3], z[3:]
        j = jacobian(q)
        g = [f - x for f, x in zip(tip(q), TARGET)]
        return [q[i] - START[i] - j[0][i] * m[0] - j[1][i] * m[1]
                for i in range(3)] + [1e-2 * x for x in g]

    z = list(q) + [0.0, 0.0]
    for _ in range(60):
        f = conditions(z)
        columns = []
        for i in range(5):
            h = 1e-6 if i < 3 else 1e-9
            up, down = z[:], z[:]
            up[i] += h
            down[i] -= h
            columns.append([(u - d) / (2 * h) for u, d in
                            zip(conditions(up), conditions(down))])
        matrix = [list(row) for row in zip(*columns)]
        z = [a - s for a, s in zip(z, solve(matrix, f))]
    return z[:3]


def square():
    """Two links of 1.1 and 0.7 m to (0.9, 0.8) from (0.3, 0.8)."""
    q, out = [0.3, 0.8], []
    for _ in range(7):
        x, y = tip(q, (1.1, 0.7), (0, 0))
        out.append((q, math.hypot(x - 0.9, y - 0.8)))
        j = jacobian(q, (1.1, 0.7))
        s = solve(j, [x - 0.9, y - 0.8])
        q = [a - b for a, b in zip(q, s)]
    return out


def text(numbers):
    return "{" + ", ".join(repr(x) for x in numbers) + "}"


def main():
    print("// Written by make_newton.py, which says how.")
    print("#ifndef GELENK_TESTS_GOLDEN_NEWTON_H_")
    print("#define GELENK_TESTS_GOLDEN_NEWTON_H_\n")
    print("// clang-format off\nnamespace gelenk::golden {\n")
    j = jacobian(START)
    print("// Three links (150, 200, 100) from (50, 400), at (0.6, 1, -0.7).")
    print("inline constexpr double kJacobian[2][3] = {%s,\n  %s};"
          % (text(j[0]), text(j[1])))
    print("inline constexpr double kPseudoInverse[3][2] = {%s};"
          % ",\n  ".join(text(r) for r in pseudo_inverse(j)))
    print("// To (350, 700): angles, then the distance left.")
    print("inline constexpr double kPseudoInverseIterates[][4] = {")
    steps = iterates(12)
    for q, left in steps[:6]:
        print("  %s," % text(list(q) + [left]))
    print("};")
    limit = steps[-1][0]
    print("inline constexpr double kPseudoInverseLimit[3] = %s;" % text(limit))
    change = smallest_change(limit)
    print("inline constexpr double kMinimalChange[3] = %s;" % text(change))
    print("inline constexpr double kMinimalChangeLength = %r;"
          % math.dist(change, START))
    print("// Two links (1.1, 0.7) from 0, from (0.3, 0.8) to (0.9, 0.8).")
    print("inline constexpr double kNewtonIterates[][3] = {")
    for q, left in square():
        print("  %s," % text(list(q) + [left]))
    print("};\n")
    print("}  // namespace gelenk::golden\n// clang-format on\n")
    print("#endif  // GELENK_TESTS_GOLDEN_NEWTON_H_")


main()
