"""The spherical drive with its tolerances as a scene, by numbers."""

from oracles.spherical_drive import HALF, RADIUS, ROD

X, Y = RADIUS * 0.5, float(RADIUS * 0.75**0.5)  # the balls lie 30 deg off y
assert abs(HALF * 6 - 3.141592653589793) < 1e-15

POSES = {"rest": (0, 0), "middle": (40, 45), "wide": (60, 45), "far": (70, 45), "p74": (74, 45), "p75": (75, 50)}
"""Tilt and azimuth [deg]."""


def _normal(half: float) -> str:
    return f"{{kind: normal, lower: {-half} um, upper: {half} um}}"


def _off(name: str, of: str, axes: str, half: float) -> str:
    ways = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
    return "".join(
        f"  {name} {axis}: {{kind: plus_minus, of: {of}, along: {ways[axis]}, distribution: {_normal(half)}}}\n"
        for axis in axes
    )


def _point(x: float, y: float, z: float) -> str:
    return f"{{kind: point, at: [{x!r} mm, {y!r} mm, {z!r} mm]}}"


def _axis(x: float, y: float, z: float, length: float) -> str:
    return f"{{kind: axis, at: [{x!r} mm, {y!r} mm, {z!r} mm], axis: [0, 0, 1], length: {length} mm}}"


def _side(k: int) -> tuple[str, str, str, str]:
    """Parts, tolerances, joints and inputs of a nut and its rod."""
    x = -X if k == 1 else X
    at = f"{{at: [{x!r} mm, {Y!r} mm, {-ROD!r} mm]}}"
    parts = f"""
  nut {k}: {{kind: solid, placed: {at}, features: {{axis: {_axis(0.0, 0.0, 0.0, 30)}, ball: {_point(0.0, 0.0, 0.0)}}}}}
  rod {k}:
    kind: solid
    placed: {at}
    features: {{bottom: {_point(0.0, 0.0, 0.0)}, top: {_point(0.0, 0.0, ROD)}}}"""
    tolerances = (
        _off(f"rod {k}", f"rod {k}.top", "z", 20)
        + _off(f"ball {k}", f"ring.ball {k}", "xyz", 20)
        + _off(f"guide {k}", f"frame.guide {k}", "xy", 20)
    )
    play = "clearance: {diameter: 10 um, float: {kind: random}}"
    joints = f"""
      guide {k}: {{kind: prismatic, between: [frame.guide {k}, nut {k}.axis]}}
      lower {k}: {{kind: ball, between: [nut {k}.ball, rod {k}.bottom], {play}}}
      upper {k}: {{kind: ball, between: [rod {k}.top, ring.ball {k}], {play}}}"""
    inputs = f"""
      travel {k}:
        of: guide {k}
        lead: 5 mm
        deviations:
          zero: {{distribution: {_normal(5)}}}
          lead: {{distribution: {_normal(23)}, per: 300 mm}}
          backlash: {{distribution: {{kind: uniform, lower: -0.5 arcmin, upper: 0.5 arcmin}}}}
          sine: {{distribution: {{kind: arcsine, lower: -1 arcmin, upper: 1 arcmin}}}}"""
    return parts, tolerances, joints, inputs


def drive_text(
    measures: str, trials: int = 4000, middle: str = "kind: swing, between: [frame.centre, ring.centre]"
) -> str:
    """The scene.

    Args:
        measures: lines of it.
        trials: how many.
        middle: the joint between frame and ring.
    """
    sides = [_side(1), _side(2)]
    parts, tolerances, joints, inputs = ("".join(own[k] for own in sides) for k in range(4))
    poses = "".join(f"\n      {name}: {{tilt: {tilt} deg, azimuth: {at} deg}}" for name, (tilt, at) in POSES.items())
    return f"""
scene: spherical drive
parts:
  frame:
    kind: solid
    features:
      centre: {_point(0.0, 0.0, 0.0)}
      axis: {_axis(0.0, 0.0, 0.0, 20)}
      guide 1: {_axis(-X, Y, -ROD, 200)}
      guide 2: {_axis(X, Y, -ROD, 200)}
  gear 1: {{kind: solid, features: {{sphere: {{kind: sphere, at: [0 mm, 0 mm, 0 mm], diameter: 100 mm}}}}}}
  ring:
    kind: solid
    features:
      centre: {_point(0.0, 0.0, 0.0)}
      axis: {_axis(0.0, 0.0, 0.0, 20)}
      ball 1: {_point(-X, Y, 0.0)}
      ball 2: {_point(X, Y, 0.0)}
  gear 2:
    kind: solid
    placed: {{at: [0 mm, 0 mm, 100 mm]}}
    features:
      sphere: {{kind: sphere, at: [0 mm, 0 mm, 0 mm], diameter: 100 mm}}
      axis: {_axis(0.0, 0.0, 30.0, 20)}{parts}
tolerances:
{tolerances}{_off("centre", "frame.centre", "xyz", 10)}moves:
  base: {{kind: fix, part: frame}}
  fixed gear: {{kind: fix, part: gear 1}}
  drive:
    kind: close_loop
    bodies: [ring, gear 2, rod 1, nut 1, rod 2, nut 2]
    joints:
      middle: {{{middle}}}
      roll: {{kind: rolling, between: [gear 1.sphere, gear 2.sphere], carrier: ring}}{joints}
    inputs:{inputs}
    output: {{tilt: ring.axis, from: frame.axis}}
    poses:{poses}
      sweep: {{path: [rest, far], steps: 7}}
measures:
{measures}study: {{trials: {trials}}}
"""


def error(name: str, more: str) -> str:
    return f"  {name}: {{kind: direction_error, of: gear 2.axis, {more}}}\n"
