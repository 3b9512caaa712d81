"""Curves in a plane that scripts beside this one sweep to tools: Bezier points with weights, [((x, z), w), ...]."""

import math


def line(p, q):
    return [(p, 1.0), (q, 1.0)]


def arc(x, z, radius, start, end):
    """About (x, z); angles in degrees from the x axis towards z, less than 180 apart."""
    start, end = math.radians(start), math.radians(end)
    w = math.cos((end - start) / 2)
    angles = ((start, 1.0), ((start + end) / 2, w), (end, 1.0))
    return [((x + radius * math.cos(a) / k, z + radius * math.sin(a) / k), k) for a, k in angles]
