#!/usr/bin/env python3
"""Writes haul_truck.obj: a two-axle rigid dump truck of the 30 t class, by formula.

Frame: x forward, y left, z up, metres; origin on the ground below the middle of the wheelbase.
Surfaces are named for the scene's `materials`: body, cab, tyre, and side, which has a picture
(haul_truck.mtl; make_haul_truck_side.py draws it).
Usage: ./make_haul_truck.py > haul_truck.obj
"""
import math

vertices, faces, parts = [], [], []


def add(name, points, polygons):
    base = len(vertices)
    vertices.extend(points)
    parts.append((name, [[base + i + 1 for i in polygon] for polygon in polygons]))


def hexahedron(name, bottom, top):
    """Eight corners: four below, four above, both counter-clockwise seen from above."""
    add(name, bottom + top, [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5],
                             [2, 3, 7, 6], [3, 0, 4, 7]])


def box(name, x0, x1, y0, y1, z0, z1):
    plan = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    hexahedron(name, [(x, y, z0) for x, y in plan], [(x, y, z1) for x, y in plan])


def wheel(name, x, y, radius, width, segments=20):
    rim = [(radius * math.cos(2 * math.pi * k / segments),
            radius * math.sin(2 * math.pi * k / segments)) for k in range(segments)]
    points = [(x + a, y - width / 2, radius + b) for a, b in rim]
    points += [(x + a, y + width / 2, radius + b) for a, b in rim]
    sides = [[k, segments + k, segments + (k + 1) % segments, (k + 1) % segments]
             for k in range(segments)]
    add(name, points, sides + [list(range(segments)),
                               list(range(2 * segments - 1, segments - 1, -1))])


def plate(name, a, b, c, d, thickness):
    """A plate on the quadrilateral a b c d, thickened against its normal."""
    u = [b[i] - a[i] for i in range(3)]
    v = [d[i] - a[i] for i in range(3)]
    n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    length = math.sqrt(sum(k * k for k in n))
    shift = [-thickness * k / length for k in n]
    corners = [a, b, c, d]
    hexahedron(name, [tuple(p[i] + shift[i] for i in range(3)) for p in corners], corners)


box("frame", -3.3, 3.6, -0.6, 0.6, 0.9, 1.5)
box("engine", 1.9, 3.9, -1.2, 1.2, 1.3, 2.4)
box("cab", 1.5, 3.1, 0.1, 1.5, 2.4, 3.9)
box("deck", 1.5, 3.9, -1.5, 1.5, 2.35, 2.45)
for side in (-1.0, 1.0):
    wheel("front_wheel", 2.1, 1.3 * side, 0.85, 0.55)
    wheel("rear_wheel", -2.1, 1.2 * side, 0.85, 1.0)
# The dump body: floor rising to the tail, sides, front wall and the canopy over the cab.
nose, tail, half = 1.3, -4.4, 1.7
floor_front, floor_tail, rim = 1.65, 2.15, 3.3
plate("body_floor", (nose, half, floor_front), (tail, half, floor_tail),
      (tail, -half, floor_tail), (nose, -half, floor_front), 0.06)
for side in (-1.0, 1.0):
    y, lip = half * side, (half + 0.15) * side
    plate("body_side", (tail, y, floor_tail), (nose, y, floor_front), (nose, lip, rim),
          (tail, lip, rim - 0.25), 0.06)
plate("body_front", (nose, -half, floor_front), (nose, half, floor_front),
      (nose + 0.25, half, 4.1), (nose + 0.25, -half, 4.1), 0.06)
plate("canopy", (nose + 0.25, -half, 4.1), (nose + 0.25, half, 4.1), (3.7, half, 4.3),
      (3.7, -half, 4.3), 0.06)

print("# Written by make_haul_truck.py; x forward, y left, z up, metres.")
print("mtllib haul_truck.mtl")
for x, y, z in vertices:
    print(f"v {x:.5f} {y:.5f} {z:.5f}")
coordinates = {}


def coordinate(vertex):
    """Where a vertex lies in the picture of the sides, seen from outside; new ones are written."""
    x, y, z = vertices[vertex - 1]
    along = (x - tail) / (nose - tail)
    place = f"vt {along if y < 0 else 1 - along:.5f} {(z - floor_front) / (rim - floor_front):.5f}"
    if place not in coordinates:
        coordinates[place] = len(coordinates) + 1
        print(place)
    return coordinates[place]


for name, polygons in parts:
    print(f"o {name}")
    has_picture = name == "body_side"
    print("usemtl " + ("side" if has_picture else "tyre" if name.endswith("wheel") else
                       name if name == "cab" else "body"))
    for polygon in polygons:
        print("f " + " ".join(f"{i}/{coordinate(i)}" if has_picture else str(i) for i in polygon))
