"""Bodies of the bank: functions that are negative inside, about as far from the surface as their value."""
import numpy


def length(p):
    return numpy.sqrt((p * p).sum(1))


def ball(centre, radius):
    return lambda p: length(p - centre) - radius


def box(half, round_by=0.0, centre=(0, 0, 0)):
    half = numpy.asarray(half) - round_by

    def value(p):
        q = numpy.abs(p - centre) - half
        return length(numpy.maximum(q, 0)) + numpy.minimum(q.max(1), 0) - round_by
    return value


def capsule(a, b, radius):
    a, b = numpy.asarray(a, float), numpy.asarray(b, float)

    def value(p):
        along = numpy.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        return length(p - a - along[:, None] * (b - a)) - radius
    return value


def torus(large, small, centre=(0, 0, 0), axis=2):
    def value(p):
        q = p - centre
        flat = numpy.delete(q, axis, 1)
        return numpy.hypot(length(flat) - large, q[:, axis]) - small
    return value


def pillar(radius, half, centre=(0, 0, 0), axis=2):
    def value(p):
        q = p - centre
        d = numpy.stack([length(numpy.delete(q, axis, 1)) - radius, numpy.abs(q[:, axis]) - half], 1)
        return numpy.minimum(d.max(1), 0) + length(numpy.maximum(d, 0))
    return value


def union(*parts):
    return lambda p: numpy.min([part(p) for part in parts], 0)


def smooth_union(k, *parts):
    def value(p):
        all_values = numpy.array([part(p) for part in parts])
        least = all_values.min(0)
        return least - k * numpy.log(numpy.exp((least - all_values) / k).sum(0))
    return value


def minus(a, *holes):
    return lambda p: numpy.max([a(p)] + [-h(p) for h in holes], 0)


def both(a, b):
    return lambda p: numpy.maximum(a(p), b(p))


def shell(a, wall):
    return lambda p: numpy.abs(a(p) + wall / 2) - wall / 2


def bowl(wall):
    return both(shell(ball((0, 0, 0), 1), wall), box((2, 2, 0.6), centre=(0, 0, -0.6)))


def mug(wall):
    inner = pillar(0.6 - wall, 0.8, (0, 0, wall))
    return union(minus(pillar(0.6, 0.8), inner), minus(torus(0.4, 0.09, (0.68, 0, 0), 1), pillar(0.57, 2)))


def holed_plate(count, thick):
    holes = [pillar(0.12, 1, (-0.9 + 1.8 * (n + 0.5) / count, 0, 0)) for n in range(count)]
    return minus(box((1, 0.4, thick), 0.3 * thick), *holes)


def lumps(seed):
    random = numpy.random.default_rng(seed)
    balls = [ball((0, 0, 0), 0.45)]
    balls += [ball(0.55 * d / numpy.linalg.norm(d), random.uniform(0.15, 0.35)) for d in random.normal(size=(6, 3))]
    return smooth_union(0.05, *balls)


def tree(seed, radius):
    random = numpy.random.default_rng(seed)
    parts = [capsule((0, 0, -1), (0, 0, 0.2), 2 * radius)]
    for n in range(6):
        turn = 2 * numpy.pi * (n + 0.3 * random.random()) / 6
        parts.append(capsule((0, 0, -0.6 + 0.15 * n), (0.8 * numpy.cos(turn), 0.8 * numpy.sin(turn), -0.2 + 0.2 * n), radius))
    return smooth_union(0.02, *parts)


def star(count, radius):
    turns = 2 * numpy.pi * numpy.arange(count) / count
    return union(ball((0, 0, 0), 0.35), *[capsule((0, 0, 0), (numpy.cos(t), numpy.sin(t), 0), radius) for t in turns])


def stool(leg):
    legs = [capsule((x, y, -0.9), (0.8 * x, 0.8 * y, 0), leg) for x in (-0.6, 0.6) for y in (-0.6, 0.6)]
    return union(box((0.8, 0.8, 0.08), 0.03), *legs)


def sword(thick):
    return union(box((0.07, 1.2, thick)), box((0.3, 0.05, 0.05), centre=(0, -0.8, 0)), capsule((0, -1.2, 0), (0, -0.8, 0), 0.05))


def chain(count, gap):
    return union(*[torus(0.35, 0.08, ((0.54 - gap) * (n - (count - 1) / 2), 0, 0), 2 if n % 2 else 1) for n in range(count)])


def gear(teeth):
    turns = 2 * numpy.pi * numpy.arange(teeth) / teeth
    return minus(union(pillar(0.75, 0.2), *[capsule((0.75 * numpy.cos(t), 0.75 * numpy.sin(t), -0.15),
                                                     (0.75 * numpy.cos(t), 0.75 * numpy.sin(t), 0.15), 0.09) for t in turns]),
                 pillar(0.25, 1))


def lattice(bar):
    ends = numpy.array([(x, y, z) for x in (-0.7, 0.7) for y in (-0.7, 0.7) for z in (-0.7, 0.7)])
    pairs = [(a, b) for a in ends for b in ends if tuple(a) < tuple(b) and (a != b).sum() == 1]
    return union(*[capsule(a, b, bar) for a, b in pairs])


def pipe(wall):
    return minus(pillar(0.5, 1), pillar(0.5 - wall, 2))


def two_balls(gap):
    return union(ball((-0.5 - gap / 2, 0, 0), 0.5), ball((0.5 + gap / 2, 0, 0), 0.5))


def tunnelled(count):
    turns = numpy.pi * numpy.arange(count) / count
    ways = [capsule((-2 * numpy.cos(t), -2 * numpy.sin(t), z), (2 * numpy.cos(t), 2 * numpy.sin(t), z), 0.14)
            for t, z in zip(turns, numpy.linspace(-0.45, 0.45, count))]
    return minus(ball((0, 0, 0), 1), *ways)


def turned(value, turn, axis=2):
    """The body turned around an axis by so many radians."""
    i, j = [n for n in range(3) if n != axis]
    matrix = numpy.eye(3)
    matrix[[i, i, j, j], [i, j, i, j]] = numpy.cos(turn), -numpy.sin(turn), numpy.sin(turn), numpy.cos(turn)
    return lambda p: value(p @ matrix)


def wire(places, radius):
    return union(*[capsule(a, b, radius) for a, b in zip(places, places[1:])])


def helix(turns, radius):
    t = numpy.linspace(0, 2 * numpy.pi * turns, 20 * turns + 1)
    return wire(numpy.stack([0.6 * numpy.cos(t), 0.6 * numpy.sin(t), -0.9 + 1.8 * t / t[-1]], 1), radius)


def knot(radius):
    t = numpy.linspace(0, 2 * numpy.pi, 73)
    return wire(0.36 * numpy.stack([numpy.sin(t) + 2 * numpy.sin(2 * t), numpy.cos(t) - 2 * numpy.cos(2 * t), -1.5 * numpy.sin(3 * t)], 1), radius)


def comb(teeth, thick):
    return union(box((1, 0.15, thick), centre=(0, -0.5, 0)),
                 *[box((thick, 0.5, thick), centre=(x, 0, 0)) for x in numpy.linspace(-0.9, 0.9, teeth)])


def tray(wall):
    return minus(box((1, 0.7, 0.25), 0.05), box((1 - wall, 0.7 - wall, 0.25), centre=(0, 0, wall)))


def ladder(rungs, radius):
    rails = [capsule((x, -1.2, 0), (x, 1.2, 0), radius) for x in (-0.35, 0.35)]
    return union(*rails, *[capsule((-0.35, y, 0), (0.35, y, 0), radius) for y in numpy.linspace(-0.9, 0.9, rungs)])


def hand(radius):
    fingers = [capsule((x, 0.2, 0), (1.6 * x, 1.0 - x * x, 0), radius) for x in numpy.linspace(-0.42, 0.42, 4)]
    return smooth_union(0.02, box((0.5, 0.5, 0.14), 0.1, (0, -0.2, 0)), capsule((0.4, -0.3, 0), (0.95, 0.1, 0.15), radius), *fingers)


def propeller(blades, thick):
    blade = turned(box((0.5, 0.16, thick), centre=(0.6, 0, 0)), 0.4, 0)
    return union(pillar(0.18, 0.2), *[turned(blade, 2 * numpy.pi * n / blades) for n in range(blades)])


def later():
    """Bodies made after most limits of the program were set."""
    yield from ((f"helix {n} {r}", helix(n, r), (1,), 0) for n, r in ((2, 0.12), (3, 0.06)))
    yield from ((f"knot {r}", knot(r), (1,), 1) for r in (0.14, 0.07))
    yield from ((f"comb {n} {t}", comb(n, t), (1,), 0) for n, t in ((5, 0.08), (8, 0.04)))
    yield from ((f"tray {w}", tray(w), (1,), 0) for w in (0.12, 0.06, 0.03))
    yield from ((f"ladder {n} {r}", ladder(n, r), (1,), n - 1) for n, r in ((3, 0.1), (6, 0.05)))
    yield from ((f"hand {r}", hand(r), (1,), 0) for r in (0.11, 0.07))
    yield from ((f"propeller {n} {t}", propeller(n, t), (1,), 0) for n, t in ((3, 0.06), (5, 0.025)))
    yield from ((f"dumbbell {r}", union(ball((-0.7, 0, 0), 0.4), ball((0.7, 0, 0), 0.3), capsule((-0.7, 0, 0), (0.7, 0, 0), r)), (1,), 0)
                for r in (0.12, 0.05))
    yield from ((f"frame {t}", minus(box((1, 0.8, t)), box((0.8, 0.6, 1))), (1,), 1) for t in (0.1, 0.04))
    yield from ((f"lens {d}", both(ball((0, 0, -d), 1), ball((0, 0, d), 1)), (1,), 0) for d in (0.6, 0.85))
    yield from ((f"cup {w}", minus(pillar(0.45, 0.9), pillar(0.45 - w, 0.9, (0, 0, w))), (1,), 0) for w in (0.1, 0.05))
    yield "jack", union(*[capsule(-0.9 * e, 0.9 * e, 0.14) for e in numpy.eye(3)]), (1,), 0
    yield "bag", union(box((0.6, 0.3, 0.5), 0.1, (0, 0, -0.4)), torus(0.4, 0.06, (0, 0, 0.05), 1)), (1,), 1
    yield "wedge", both(box((0.8, 0.5, 0.6)), lambda p: (p[:, 2] + 0.75 * p[:, 0]) / 1.25), (1,), 0
    yield "two boxes", union(box((0.4, 0.5, 0.5), centre=(-0.42, 0, 0)), box((0.4, 0.5, 0.5), centre=(0.42, 0, 0))), (2,), 0


def half_spaces(*planes):
    """Within planes, each told by its normal and its distance from the middle."""
    normals, offsets = numpy.array([p[0] for p in planes], float), numpy.array([p[1] for p in planes], float)
    sizes = numpy.linalg.norm(normals, axis=1)
    return lambda p: (p @ (normals / sizes[:, None]).T - offsets).max(1)


def cone(low, high, r_low, r_high):
    """Around z from `low` to `high`."""
    slope = (r_high - r_low) / (high - low)

    def value(p):
        side = (length(p[:, :2]) - r_low - slope * (p[:, 2] - low)) / numpy.hypot(1, slope)
        return numpy.maximum(side, numpy.maximum(low - p[:, 2], p[:, 2] - high))
    return value


def crystal(seed, count):
    normals = numpy.random.default_rng(seed).normal(size=(count, 3))
    return half_spaces(*[(n, 0.7) for n in normals], *[(s * e, 0.9) for e in numpy.eye(3) for s in (-1, 1)])


def chair(leg):
    legs = [capsule((x, y, -1), (x, y, -0.1), leg) for x in (-0.4, 0.4) for y in (-0.4, 0.4)]
    return union(box((0.5, 0.5, leg), 0.02, (0, 0, -0.1)), box((0.5, leg, 0.5), 0.02, (0, 0.45, 0.4)), *legs)


def grid_plate(count, thick):
    places = 0.9 * (2 * numpy.arange(count) + 1 - count) / count
    return minus(box((1, 1, thick), 0.2 * thick), *[box((0.5 / count, 0.5 / count, 1), centre=(x, y, 0)) for x in places for y in places])


def wheel(spokes, radius):
    turns = 2 * numpy.pi * numpy.arange(spokes) / spokes
    return union(torus(0.9, 1.5 * radius), pillar(0.2, 0.12), *[capsule((0, 0, 0), (0.9 * numpy.cos(t), 0.9 * numpy.sin(t), 0), radius) for t in turns])


def bottle(wall):
    outer = smooth_union(0.03, cone(-0.9, 0.3, 0.45, 0.45), cone(0.25, 0.5, 0.45, 0.18), cone(0.45, 0.95, 0.18, 0.18))
    inner = smooth_union(0.03, cone(-0.9 + wall, 0.3, 0.45 - wall, 0.45 - wall), cone(0.25, 0.5, 0.45 - wall, 0.18 - wall),
                         cone(0.45, 1.2, 0.18 - wall, 0.18 - wall))
    return minus(outer, inner)


def fork(radius):
    tines = [capsule((x, 0.3, 0), (x, 1, 0), radius) for x in numpy.linspace(-0.24, 0.24, 4)]
    return union(capsule((0, -1.1, 0), (0, 0.1, 0), 1.4 * radius), box((0.24 + radius, 0.12, radius), centre=(0, 0.2, 0)), *tines)


def spectacles(radius):
    bows = [capsule((s * 0.9, 0, 0), (s * 0.9, 0, -1), radius) for s in (-1, 1)]
    return union(torus(0.38, radius, (-0.52, 0, 0)), torus(0.38, radius, (0.52, 0, 0)), capsule((-0.15, 0, 0), (0.15, 0, 0), radius), *bows)


def snow(radius):
    parts = []
    for t in numpy.pi / 3 * numpy.arange(6):
        at = lambda r, turn: r * numpy.array([numpy.cos(t + turn), numpy.sin(t + turn), 0])
        parts += [capsule((0, 0, 0), at(1, 0), radius)]
        parts += [capsule(at(0.6, 0), at(0.6, 0) + at(0.3, turn), radius) for turn in (-numpy.pi / 3, numpy.pi / 3)]
    return union(*parts)


def screw(turns):
    t = numpy.linspace(0, 2 * numpy.pi * turns, 20 * turns + 1)
    thread = numpy.stack([0.22 * numpy.cos(t), 0.22 * numpy.sin(t), -0.9 + 1.2 * t / t[-1]], 1)
    return union(pillar(0.22, 0.8, (0, 0, -0.2)), pillar(0.42, 0.12, (0, 0, 0.7)), wire(thread, 0.06))


def pitted(count):
    random = numpy.random.default_rng(3)
    ways = random.normal(size=(count, 3))
    return minus(ball((0, 0, 0), 0.9), *[ball(0.95 * w / numpy.linalg.norm(w), random.uniform(0.1, 0.25)) for w in ways])


def aerofoil(thick):
    return both(both(ball((0, 0, 0), 1.3), box((0.5, 1, 1))), lambda p: (numpy.abs(p[:, 2]) - thick * (0.5 - p[:, 0])) / numpy.hypot(1, thick))


def latest():
    """Bodies made after most limits of the verdict were set."""
    yield "roof", half_spaces(((0, 0, -1), 0.3), ((1, 0, 1), 0.3), ((-1, 0, 1), 0.3), ((0, 1, 0), 0.9), ((0, -1, 0), 0.9)), (1,), 0
    yield "double cone", union(cone(-1, 0, 0.01, 0.5), cone(0, 1, 0.5, 0.01)), (1,), 0
    yield from ((f"disc {t}", pillar(0.9, t), (1,), 0) for t in (0.06, 0.03))
    yield from ((f"hollow ball {w}", shell(ball((0, 0, 0), 0.9), w), (2,), 0) for w in (0.2, 0.08))
    yield from ((f"chair {r}", chair(r), (1,), 0) for r in (0.09, 0.05))
    yield from ((f"grid plate {n} {t}", grid_plate(n, t), (1,), n * n) for n, t in ((2, 0.12), (3, 0.06)))
    yield "arch", both(torus(0.7, 0.2, (0, 0, -0.4), 1), half_spaces(((0, 0, -1), 0.4))), (1,), 0
    yield "spool", union(pillar(0.7, 0.06, (0, 0, -0.5)), pillar(0.7, 0.06, (0, 0, 0.5)), pillar(0.25, 0.5)), (1,), 0
    yield "key", union(torus(0.3, 0.08, (0, 0.8, 0)), capsule((0, 0.5, 0), (0, -0.9, 0), 0.09), box((0.18, 0.06, 0.06), centre=(0.2, -0.8, 0)),
                       box((0.15, 0.06, 0.06), centre=(0.17, -0.55, 0))), (1,), 1
    yield from ((f"bottle {w}", bottle(w), (1,), 0) for w in (0.09, 0.05))
    yield from ((f"pan {w}", union(minus(pillar(0.6, 0.15), pillar(0.6 - w, 0.15, (0, 0, w))), capsule((0.58, 0, 0), (1.3, 0, 0.05), 0.07)), (1,), 0)
                for w in (0.1, 0.05))
    yield from ((f"fork {r}", fork(r), (1,), 0) for r in (0.07, 0.04))
    yield from ((f"spectacles {r}", spectacles(r), (1,), 2) for r in (0.07, 0.04))
    yield "basket", union(minus(pillar(0.6, 0.3, (0, 0, -0.3)), pillar(0.5, 0.3, (0, 0, -0.2))), both(torus(0.55, 0.06, (0, 0, -0.1), 1),
                                                                                                  half_spaces(((0, 0, -1), 0.1)))), (1,), 1
    yield from ((f"crystal {n}", crystal(n, n), (1,), 0) for n in (7, 16))
    yield "screw", screw(6), (1,), 0
    yield from ((f"aerofoil {t}", aerofoil(t), (1,), 0) for t in (0.25, 0.1))
    yield from ((f"snow {r}", snow(r), (1,), 0) for r in (0.09, 0.05))
    yield from ((f"wheel {n} {r}", wheel(n, r), (1,), n) for n, r in ((4, 0.1), (7, 0.05)))
    yield "pitted ball", pitted(24), (1,), 0
    yield "stairs", union(*[box((0.2, 0.5, 0.1 * n), centre=(-0.9 + 0.36 * n, 0, 0.1 * n - 0.5)) for n in range(1, 6)]), (1,), 0
    yield "two rings", union(torus(0.5, 0.12, (0, 0, -0.2)), torus(0.5, 0.12, (0, 0, 0.2))), (2,), 2
    yield from ((f"band {w}", minus(pillar(0.9, 0.25), pillar(0.9 - w, 1)), (1,), 1) for w in (0.12, 0.06))
    yield from ((f"bracket {t}", minus(union(box((0.6, 0.4, t), centre=(0, 0, -0.6)), box((t, 0.4, 0.6), centre=(-0.6 + t, 0, 0))),
                                       pillar(0.15, 2, (0.15, 0, 0))), (1,), 1) for t in (0.1, 0.05))
    yield from ((f"funnel {w}", minus(cone(-0.8, 0.8, 0.2, 0.9), cone(-0.81, 0.81, 0.2 - w, 0.9 - w)), (1,), 1) for w in (0.12, 0.07))
    yield "corrugated", both(lambda p: (numpy.abs(p[:, 2] - 0.15 * numpy.sin(8 * p[:, 0])) - 0.06) / 1.4, box((1, 0.6, 1))), (1,), 0
    yield "three balls", union(*[ball((0.8 * n, 0, 0), 0.35) for n in (-1, 0, 1)]), (3,), 0


def prism(corners, radius, half):
    """Regular, along z; `radius` of the circle within."""
    turns = 2 * numpy.pi * numpy.arange(corners) / corners
    return half_spaces(*[((numpy.cos(t), numpy.sin(t), 0), radius) for t in turns], ((0, 0, 1), half), ((0, 0, -1), half))


def goblet(wall):
    cup = both(shell(ball((0, 0, 0.5), 0.5), wall), half_spaces(((0, 0, 1), 0.6)))
    return union(cup, capsule((0, 0, 0), (0, 0, -0.8), 0.08), pillar(0.4, 0.05, (0, 0, -0.85)))


def shelf(count, wall):
    high = 2 / count
    return minus(box((0.6, 0.3, 1)), *[box((0.6 - wall, 0.3, 0.5 * high - 0.5 * wall), centre=(0, wall, -1 + (n + 0.5) * high)) for n in range(count)])


def tee(wall):
    outside = union(pillar(0.35, 1), pillar(0.35, 0.5, (0, 0.5, 0), 1))
    return minus(outside, pillar(0.35 - wall, 1.2), pillar(0.35 - wall, 0.6, (0, 0.6, 0), 1))


def boat(wall):
    ellipsoid = lambda p: (length(p / (1.2, 0.5, 0.5)) - 1) * 0.5
    return both(shell(ellipsoid, wall), half_spaces(((0, 0, 1), 0)))


def brush(count, radius):
    places = 0.45 * (2 * numpy.arange(count) + 1 - count) / count
    return union(box((1, 0.5, 0.1), centre=(0, 0, -0.3)), *[capsule((2 * x, y, -0.3), (2 * x, y, 0.3), radius) for x in places for y in places])


def clip(radius):
    path = [(-0.6, 0.1, 0), (0.7, 0.1, 0), (0.8, 0.2, 0), (0.7, 0.4, 0), (-0.8, 0.4, 0), (-1, 0.2, 0), (-1, -0.2, 0), (-0.8, -0.4, 0), (0.8, -0.4, 0)]
    return wire(numpy.array(path), radius)


def honeycomb(thick):
    holes = [pillar(0.16, 1, (0, 0, 0))] + [pillar(0.16, 1, (0.45 * numpy.cos(t), 0.45 * numpy.sin(t), 0)) for t in numpy.pi / 3 * numpy.arange(6)]
    return minus(prism(6, 0.8, thick), *holes)


def spiral(radius):
    t = numpy.linspace(0, 5 * numpy.pi, 80)
    return wire(numpy.stack([(0.15 + 0.05 * t) * numpy.cos(t), (0.15 + 0.05 * t) * numpy.sin(t), 0 * t], 1), radius)


def newest():
    """Bodies made after `cloud.cut_off` was added and all limits were set."""
    yield from ((f"hook {r}", union(both(torus(0.45, r, (0, 0.4, 0)), half_spaces(((-0.7, -1, 0), 0))), capsule((0.45, 0.4, 0), (0.3, -1, 0), r)), (1,), 0)
                for r in (0.1, 0.06))
    yield from ((f"goblet {w}", goblet(w), (1,), 0) for w in (0.1, 0.06))
    yield "round table", union(pillar(0.9, 0.06, (0, 0, 0.5)), pillar(0.1, 0.5), pillar(0.5, 0.06, (0, 0, -0.5))), (1,), 0
    yield "kettle", union(ball((0, 0, 0), 0.6), torus(0.45, 0.07, (0, 0, 0.5), 1), capsule((0.4, 0, 0), (1, 0, 0.4), 0.12)), (1,), 1
    yield "mushroom", union(both(ball((0, 0, 0.2), 0.7), half_spaces(((0, 0, -1), -0.2))), capsule((0, 0, -0.8), (0, 0, 0.3), 0.18)), (1,), 0
    yield from ((f"umbrella {w}", union(both(shell(ball((0, 0, -0.2), 1), w), half_spaces(((0, 0, -1), -0.3))), capsule((0, 0, -0.9), (0, 0, 0.75), 0.06)),
                 (1,), 0) for w in (0.12, 0.07))
    yield from ((f"shelf {n} {w}", shelf(n, w), (1,), 0) for n, w in ((3, 0.08), (4, 0.05)))
    yield "nut", minus(prism(6, 0.7, 0.3), pillar(0.4, 1)), (1,), 1
    yield "bolt", union(prism(6, 0.45, 0.2), pillar(0.22, 0.7, (0, 0, -0.6))), (1,), 0
    yield from ((f"beam {t}", union(box((1.2, 0.4, t), centre=(0, 0, 0.4)), box((1.2, 0.4, t), centre=(0, 0, -0.4)), box((1.2, t, 0.4))), (1,), 0)
                for t in (0.08, 0.04))
    yield from ((f"tee {w}", tee(w), (1,), 2) for w in (0.1, 0.06))
    yield from ((f"boat {w}", boat(w), (1,), 0) for w in (0.12, 0.06))
    yield from ((f"brush {n} {r}", brush(n, r), (1,), 0) for n, r in ((3, 0.08), (4, 0.05)))
    yield "cactus", union(capsule((0, 0, -0.9), (0, 0, 0.9), 0.2), *[union(capsule((0, 0, z), (0.55 * s, 0, z), 0.12), capsule((0.55 * s, 0, z), (0.55 * s, 0, z + 0.5), 0.12))
                                                                  for s, z in ((1, -0.2), (-1, 0.1))]), (1,), 0
    yield from ((f"honeycomb {t}", honeycomb(t), (1,), 7) for t in (0.12, 0.06))
    yield "barrel", shell(pillar(0.5, 0.8), 0.15), (2,), 0
    yield from ((f"spiral {r}", spiral(r), (1,), 0) for r in (0.08, 0.04))
    yield "pyramid", half_spaces(((1, 0, 0.6), 0.5), ((-1, 0, 0.6), 0.5), ((0, 1, 0.6), 0.5), ((0, -1, 0.6), 0.5), ((0, 0, -1), 0.4)), (1,), 0
    yield "drop", union(ball((0, 0, -0.3), 0.5), cone(-0.1, 0.9, 0.46, 0.01)), (1,), 0
    yield from ((f"clip {r}", clip(r), (1,), 0) for r in (0.06, 0.035))
    yield from ((f"fin {t}", both(box((0.7, t, 0.9)), half_spaces(((1, 0, 0.6), 0.4))), (1,), 0) for t in (0.1, 0.05))
    yield "two plates", union(box((0.8, 0.8, 0.08), centre=(0, 0, 0.25)), box((0.8, 0.8, 0.08), centre=(0, 0, -0.25))), (2,), 0
    yield "hill", (lambda p: p[:, 2] - 0.4 * numpy.exp(-3 * (p[:, 0] ** 2 + p[:, 1] ** 2))), (1,), None


def freshest():
    """Bodies that nothing was chosen on."""
    yield "anchor", union(both(torus(0.6, 0.09, (0, 0, 0), 1), half_spaces(((0, 0, 1), 0))), capsule((0, 0, -0.6), (0, 0, 0.9), 0.09),
                          capsule((-0.4, 0, 0.6), (0.4, 0, 0.6), 0.08)), (1,), 0
    yield "hourglass", union(cone(-0.9, 0, 0.6, 0.1), cone(0, 0.9, 0.1, 0.6)), (1,), 0
    yield "flask", union(ball((0, 0, -0.3), 0.6), capsule((0, 0, 0), (0, 0, 0.9), 0.15)), (1,), 0
    yield from ((f"cross plate {t}", union(box((1, 0.25, t), 0.3 * t), box((0.25, 1, t), 0.3 * t)), (1,), 0) for t in (0.08, 0.04))
    yield "crown", minus(pillar(0.7, 0.4), pillar(0.58, 1), box((2, 0.15, 0.3), centre=(0, 0, 0.3)), box((0.15, 2, 0.3), centre=(0, 0, 0.3))), (1,), 1
    yield from ((f"channel {t}", minus(box((1, 0.4, 0.4)), box((2, 0.4 - t, 0.4), centre=(0, 0, t))), (1,), 0) for t in (0.12, 0.06))
    yield "three discs", union(pillar(0.1, 0.8), *[pillar(0.6, 0.07, (0, 0, z)) for z in (-0.6, 0, 0.6)]), (1,), 0
    yield "clover", minus(union(*[pillar(0.42, 0.08, (0.42 * numpy.cos(t), 0.42 * numpy.sin(t), 0)) for t in 2 * numpy.pi / 3 * numpy.arange(3)]),
                          *[pillar(0.2, 1, (0.45 * numpy.cos(t), 0.45 * numpy.sin(t), 0)) for t in 2 * numpy.pi / 3 * numpy.arange(3)]), (1,), 3
    yield "bench", union(box((1, 0.3, 0.06), centre=(0, 0, 0.3)), box((0.06, 0.3, 0.35), centre=(-0.7, 0, 0)), box((0.06, 0.3, 0.35), centre=(0.7, 0, 0))), (1,), 0
    yield "plug", union(box((0.4, 0.3, 0.4), 0.05), *[box((0.06, 0.12, 0.3), centre=(x, 0, 0.6)) for x in (-0.2, 0.2)]), (1,), 0
    yield from ((f"dish {w}", both(shell(ball((0, 0, 0.6), 1.2), w), half_spaces(((0, 0, 1), -0.1))), (1,), 0) for w in (0.12, 0.07))
    yield "beads", union(torus(0.7, 0.08), *[ball((0.7 * numpy.cos(t), 0.7 * numpy.sin(t), 0), 0.2) for t in numpy.pi / 2 * numpy.arange(4)]), (1,), 1


def solids():
    """(name, function, the numbers of parts that are right, handles)"""
    yield from ((f"rounded box {a}", box((1, a, 0.4 * a), 0.1 * a), (1,), 0) for a in (0.9, 0.5, 0.25, 0.12))
    yield from ((f"bowl {w}", bowl(w), (1,), 0) for w in (0.15, 0.08, 0.04, 0.02))
    yield from ((f"mug {w}", mug(w), (1,), 1) for w in (0.15, 0.08, 0.04))
    yield from ((f"holed plate {n} {t}", holed_plate(n, t), (1,), n) for n, t in ((2, 0.1), (3, 0.1), (5, 0.06), (5, 0.03)))
    yield from ((f"lumps {s}", lumps(s), (1,), 0) for s in range(5))
    yield from ((f"tree {r}", tree(n, r), (1,), 0) for n, r in enumerate((0.12, 0.08, 0.05, 0.03)))
    yield from ((f"star {n} {r}", star(n, r), (1,), 0) for n, r in ((5, 0.12), (7, 0.08), (9, 0.04)))
    yield from ((f"stool {r}", stool(r), (1,), 0) for r in (0.1, 0.06, 0.03))
    yield from ((f"sword {t}", sword(t), (1,), 0) for t in (0.05, 0.025, 0.012))
    yield from ((f"chain {n} {g}", chain(n, g), (2, 3, 4) if n == 4 else (n,), n) for n, g in ((2, 0.05), (3, 0.005), (4, 0.1)))
    yield from ((f"gear {n}", gear(n), (1,), 1) for n in (8, 14, 22))
    yield from ((f"lattice {b}", lattice(b), (1,), 5) for b in (0.16, 0.1, 0.06, 0.03))
    yield from ((f"pipe {w}", pipe(w), (1,), 1) for w in (0.2, 0.1, 0.05, 0.02))
    yield from ((f"two balls {g}", two_balls(g), (1, 2) if g < 0.01 else (2,), 0) for g in (0.001, 0.02, 0.05, 0.2))
    yield from ((f"tunnelled {n}", tunnelled(n), (1,), n) for n in (1, 2, 3))
    yield from ((f"ring {r}", torus(0.9, r), (1,), 1) for r in (0.3, 0.12, 0.05, 0.025))


def sheets():
    """(name, function, which of its points are there): open surfaces."""
    hills = lambda p: p[:, 2] - 0.12 * numpy.sin(4 * p[:, 0]) * numpy.cos(3 * p[:, 1]) - 0.05 * numpy.sin(9 * p[:, 0] + 4 * p[:, 1])
    within = lambda p: numpy.abs(p[:, :2]).max(1) < 1
    yield "terrain", hills, within
    yield "half shell", ball((0, 0, 0), 1), lambda p: p[:, 2] > 0
    yield "cap", ball((0, 0, 0), 1), lambda p: p[:, 2] > 0.6
    yield "open tube", lambda p: length(p[:, :2]) - 0.4, lambda p: numpy.abs(p[:, 2]) < 1
    yield "wavy wall", lambda p: p[:, 1] - 0.2 * numpy.sin(3 * p[:, 0]), lambda p: numpy.abs(p[:, [0, 2]]).max(1) < 1


def points_on(value, count, seed, keep=None, extent=1.45):
    """Points spread evenly over the area where `value` is 0."""
    random = numpy.random.default_rng(seed)
    cells = 56
    side = 2 * extent / cells
    axis = -extent + side * (numpy.arange(cells) + 0.5)
    centres = numpy.stack(numpy.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    near = centres[numpy.abs(value(centres)) < 1.2 * side]
    found, have, band = [], 0, 0.25 * side
    while have < count:
        p = near[random.integers(len(near), size=count)] + side * (random.random((count, 3)) - 0.5)
        f = value(p)
        p = p[numpy.abs(f) < 2 * band]
        for step in range(3):
            f = value(p)
            slope = numpy.stack([(value(p + h) - f) / 1e-6 for h in 1e-6 * numpy.eye(3)], 1)
            size2 = numpy.maximum((slope ** 2).sum(1), 1e-6)
            if step == 0:
                inside = numpy.abs(f) < band * numpy.sqrt(size2)
                p, f, slope, size2 = p[inside], f[inside], slope[inside], size2[inside]
            p = p - (f / size2)[:, None] * slope
        p = p[numpy.abs(value(p)) < 1e-3]
        if keep is not None:
            p = p[keep(p)]
        found.append(p)
        have += len(p)
    return numpy.concatenate(found)[:count]
