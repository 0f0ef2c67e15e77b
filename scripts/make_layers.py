#!/usr/bin/env python3
"""Writes an OBJ of big triangles behind one another, each over half of the square [-1, 1]^2.

    scripts/make_layers.py [N] > layers.obj        (default: 100)

Seen with --view front --projection orthographic --ortho-height 2 the depth complexity is about
0.4 N. The same for the same N everywhere.
"""
import random
import sys

count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
chance = random.Random(4)
corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
for k in range(count):
    depth = chance.uniform(-1, 1)
    first = chance.randrange(4)
    for n in range(3):
        x, y = corners[(first + n) % 4]
        print("v", *(f"{1.2 * c + chance.uniform(-0.1, 0.1):.6f}" for c in (x, y)),
              f"{depth + chance.uniform(-0.2, 0.2):.6f}")
    print("f", 3 * k + 1, 3 * k + 2, 3 * k + 3)
