"""Random valid scenes as a workshop would write them: spur pairs, bevel pairs, trains; tolerances of realistic sizes.

Sizes go with the module as those of ISO 1328 and ISO 286 do: some ten micrometres at a module of 2 mm.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from tol3d import Scene
from tol3d.errors import GeometryError, SceneError
from tol3d.gearing.model import model_from_scene

Data = dict[str, Any]

MODULES = (0.5, 0.8, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)  # mm
ATTEMPTS = 100  # a scene; half of the draws have undercut, pointed teeth or too much interference


def random_scenes(kind: str, count: int, seed: int) -> Iterator[Scene]:
    """Scenes of a kind: "spur", "bevel" or "train"; the k-th is the same for any count."""
    for k in range(count):
        rng = np.random.default_rng([seed, k])
        yield _first_valid(kind, rng)


def _first_valid(kind: str, rng: np.random.Generator) -> Scene:
    for _ in range(ATTEMPTS):
        try:
            scene = Scene.model_validate({"spur": _spur, "bevel": _bevel, "train": _train}[kind](rng))
            model_from_scene(scene)
        except (SceneError, GeometryError, ValueError):
            continue
        return scene
    raise AssertionError(f"no valid {kind} scene in {ATTEMPTS} attempts")


# words of scenes ------------------------------------------------------------------------------------


def um(value: float) -> str:
    return f"{value:.3f} um"


def _law(rng: np.random.Generator, low: float, high: float) -> Data:
    """A law between limits [um], of any kind."""
    kind = rng.choice(["normal", "uniform", "triangular", "truncated_normal", "constant"], p=[0.5, 0.2, 0.1, 0.1, 0.1])
    middle = (low + high) / 2
    if kind == "triangular":
        return {"kind": kind, "lower": um(low), "mode": um(rng.uniform(low, high)), "upper": um(high)}
    if kind == "truncated_normal":
        return {"kind": kind, "mean": um(middle), "sigma": um((high - low) / 4), "lower": um(low), "upper": um(high)}
    if kind == "constant":
        return {"kind": kind, "value": um(middle)}
    return {"kind": str(kind), "lower": um(low), "upper": um(high)}


def _length(rng: np.random.Generator, size: float) -> Data:
    """The law of a length of about `size` [um]."""
    return {"kind": "rayleigh", "scale": um(size)} if rng.random() < 0.8 else _law(rng, 0.5 * size, 2 * size)


def _direction(rng: np.random.Generator) -> Any:
    return "random" if rng.random() < 0.7 else {"at": f"{rng.uniform(0, 360):.1f} deg"}


def _grade(rng: np.random.Generator, module: float) -> float:
    """A unit of size [um] that goes with the module and the quality."""
    return float((2.0 + 1.5 * module) * rng.uniform(0.5, 1.5))


def _thinned(rng: np.random.Generator, grade: float) -> Data:
    low = -rng.uniform(6.0, 14.0) * grade
    return _law(rng, low, low + rng.uniform(1.0, 3.0) * grade)


# pairs ----------------------------------------------------------------------------------------------


def _spur_gear(rng: np.random.Generator, teeth: int, module: float, alpha: float, shift: float) -> Data:
    width = module * rng.uniform(5.0, 12.0)
    return {
        "kind": "spur_gear",
        "teeth": teeth,
        "module": f"{module} mm",
        "pressure_angle": f"{alpha} deg",
        "face_width": f"{width:.2f} mm",
        "profile_shift": round(shift, 3),
        "expansion": "11.5e-6 1/K",
    }


def _spur(rng: np.random.Generator) -> Data:
    module, alpha = float(rng.choice(MODULES)), float(rng.choice([17.5, 20.0, 20.0, 20.0, 25.0]))
    teeth = int(rng.integers(17, 45)), int(rng.integers(20, 130))
    shifts = rng.uniform(-0.2, 0.5, 2) if rng.random() < 0.5 else np.zeros(2)
    grade = _grade(rng, module)
    distance = module * (sum(teeth) / 2 + float(shifts.sum())) + rng.choice([0.0, 0.02]) * module
    optional: Data = {
        "wheel eccentricity": {
            "kind": "eccentricity",
            "of": "wheel",
            "distribution": _length(rng, 0.7 * grade),
            "direction": _direction(rng),
        },
        "run-out": {"kind": "run_out", "of": "pinion", "distribution": _length(rng, 0.3 * grade)},
        "wheel bearing": {
            "kind": "bearing_clearance",
            "of": "wheel",
            "direction": ["apart", "random", "tooth_force", {"at": "70 deg"}][int(rng.integers(4))],
            "distribution": _law(rng, 0.5 * grade, 2.0 * grade),
        },
        "in plane": {"kind": "axis_in_plane", "of": "pair", "distribution": _law(rng, -grade, grade)},
        "out of plane": {
            "kind": "axis_out_of_plane",
            "of": "pair",
            "distribution": _law(rng, -0.5 * grade, 0.5 * grade),
        },
        "wheel shift": {"kind": "axial_shift", "of": "wheel", "distribution": _law(rng, -50.0, 50.0)},
        "temperature": {
            "kind": "temperature",
            "of": [["pinion", "wheel", "housing"], ["pinion"], ["wheel", "housing"]][int(rng.integers(3))],
            "distribution": {"kind": "uniform", "lower": "0 K", "upper": f"{rng.uniform(5, 30):.1f} K"},
        },
    }
    return {
        "scene": "random spur pair",
        "parts": {
            "pinion": _spur_gear(rng, teeth[0], module, alpha, float(shifts[0])),
            "wheel": _spur_gear(rng, teeth[1], module, alpha, float(shifts[1])),
            "housing": {"kind": "housing", "expansion": "23e-6 1/K"},
        },
        "tolerances": {
            "pinion thickness": {"kind": "tooth_thickness", "of": "pinion", "distribution": _thinned(rng, grade)},
            "wheel thickness": {"kind": "tooth_thickness", "of": "wheel", "distribution": _thinned(rng, grade)},
            "distance": {"kind": "centre_distance", "of": "pair", "distribution": _law(rng, -2 * grade, 2 * grade)},
            "pinion eccentricity": {
                "kind": "eccentricity",
                "of": "pinion",
                "distribution": _length(rng, 0.7 * grade),
                "direction": _direction(rng),
            },
            **_some(rng, optional),
        },
        "moves": {
            "pair": {
                "kind": "mesh",
                "driver": "pinion",
                "driven": "wheel",
                "centre_distance": f"{distance:.4f} mm",
                "working_flank": str(rng.choice(["left", "right"])),
                "housing": "housing",
            }
        },
        "measures": _measures(rng),
        "study": {"seed": int(rng.integers(1, 1000))},
    }


def _some(rng: np.random.Generator, optional: Data) -> Data:
    return {name: value for name, value in optional.items() if rng.random() < 0.5}


def _measures(rng: np.random.Generator, **reading: str) -> Data:
    found: Data = {"play": {"kind": "normal_backlash", "of": "pair", **reading}}
    also: Data = {
        "turn": {"kind": "angular_backlash", "of": "pair", **reading},
        "at rest": {
            "kind": "circumferential_backlash",
            "of": "pair",
            "over": {"at": f"{rng.uniform(0, 360):.1f} deg"},
            **reading,
        },
        "least": {"kind": "normal_backlash", "of": "pair", "over": "turn", "take": "min", "positions": 12, **reading},
        "swing": {"kind": "normal_backlash", "of": "pair", "over": "turn", "take": "range", "positions": 12, **reading},
    }
    name = str(rng.choice(list(also)))
    return found | {name: also[name]}


def _bevel(rng: np.random.Generator) -> Data:
    module, alpha = float(rng.choice(MODULES[2:])), 20.0
    teeth = int(rng.integers(14, 40)), int(rng.integers(16, 60))
    shift = round(float(rng.choice([0.0, rng.uniform(-0.3, 0.3)])), 3)
    angle = float(rng.choice([90.0, 90.0, 75.0, 110.0]))
    grade = _grade(rng, module)
    width = module * rng.uniform(2.5, 4.0)

    def gear(k: int) -> Data:
        return {
            "kind": "bevel_gear",
            "teeth": teeth[k],
            "module": f"{module} mm",
            "pressure_angle": f"{alpha} deg",
            "face_width": f"{width:.2f} mm",
            "profile_shift": shift if k == 0 else -shift,
        }

    optional: Data = {
        "wheel eccentricity": {
            "kind": "eccentricity",
            "of": "wheel",
            "distribution": _length(rng, 0.7 * grade),
            "direction": _direction(rng),
        },
        "pinion bearing": {
            "kind": "bearing_clearance",
            "of": "pinion",
            "direction": ["apart", "random", "tooth_force", {"at": "70 deg"}][int(rng.integers(4))],
            "distribution": _law(rng, 0.5 * grade, 2.0 * grade),
        },
        "wheel bearing": {
            "kind": "bearing_clearance",
            "of": "wheel",
            "distribution": _law(rng, 0.5 * grade, 2.0 * grade),
        },
        "shaft angle": {
            "kind": "shaft_angle",
            "of": "pair",
            "tilts": str(rng.choice(["driver", "driven"])),
            "pivot": str(rng.choice(["apex", "mean_plane"])),
            "distribution": _law(rng, -grade, grade),
        },
        "axes offset": {"kind": "axes_offset", "of": "pair", "distribution": _law(rng, -grade, grade)},
        "pinion face": {"kind": "mounting_face", "of": "pinion", "distribution": _law(rng, -grade, grade)},
        "wheel shim": {
            "kind": "shim",
            "of": "wheel",
            "side": "behind",
            "distribution": _law(rng, 0.5 * grade, 2 * grade),
        },
    }
    reading = {"read_at": str(rng.choice(["mean_section", "mean_section", "face", "face_contact"]))}
    return {
        "scene": "random bevel pair",
        "parts": {"pinion": gear(0), "wheel": gear(1)},
        "tolerances": {
            "pinion thickness": {
                "kind": "tooth_thickness",
                "of": "pinion",
                "measured": str(rng.choice(["arc", "normal"])),
                "along_face": str(rng.choice(["proportional", "constant"])),
                "distribution": _thinned(rng, grade),
            },
            "wheel thickness": {"kind": "tooth_thickness", "of": "wheel", "distribution": _thinned(rng, grade)},
            "pinion eccentricity": {"kind": "eccentricity", "of": "pinion", "distribution": _length(rng, 0.7 * grade)},
            **_some(rng, optional),
        },
        "moves": {
            "pair": {
                "kind": "bevel_mesh",
                "driver": "pinion",
                "driven": "wheel",
                "shaft_angle": f"{angle} deg",
                "working_flank": str(rng.choice(["left", "right"])),
            }
        },
        "measures": _measures(rng, **reading),
        "study": {"seed": int(rng.integers(1, 1000))},
    }


# trains ---------------------------------------------------------------------------------------------


def _train(rng: np.random.Generator) -> Data:
    """Two meshes one behind the other, a reducer before them in half of the trains; bearings under the last shaft."""
    module, grade = float(rng.choice(MODULES)), 0.0
    grade = _grade(rng, module)
    teeth = rng.integers(18, 60, 4)
    gears = {f"gear {k}": _spur_gear(rng, int(teeth[k]), module, 20.0, 0.0) for k in range(4)}
    parts: Data = {
        **gears,
        "input": {"kind": "shaft", "carries": {"gear 0": {"at": "0 mm"}}},
        "middle": {
            "kind": "shaft",
            "carries": {"gear 1": {"at": "0 mm"}, "gear 2": {"at": "40 mm", "phase": "13 deg"}},
        },
        "output": {"kind": "shaft", "carries": {"gear 3": {"at": "0 mm"}}},
    }
    moves: Data = {
        f"mesh {k}": {
            "kind": "mesh",
            "driver": f"gear {2 * k}",
            "driven": f"gear {2 * k + 1}",
            "centre_distance": f"{module * (teeth[2 * k] + teeth[2 * k + 1]) / 2:.4f} mm",
            "azimuth": f"{rng.uniform(0, 360):.1f} deg",
        }
        for k in range(2)
    }
    tolerances: Data = {
        f"thickness {k}": {"kind": "tooth_thickness", "of": f"gear {k}", "distribution": _thinned(rng, grade)}
        for k in range(4)
    }
    tolerances |= {
        f"eccentricity {k}": {
            "kind": "eccentricity",
            "of": f"gear {k}",
            "distribution": _length(rng, 0.7 * grade),
            "direction": _direction(rng),
        }
        for k in range(4)
    }
    tolerances |= {
        f"distance {k}": {
            "kind": "centre_distance",
            "of": f"mesh {k}",
            "distribution": _law(rng, -2 * grade, 2 * grade),
        }
        for k in range(2)
    }
    tolerances["middle run-out"] = {"kind": "run_out", "of": "middle", "distribution": _length(rng, 0.3 * grade)}
    first = "input"
    if rng.random() < 0.5:
        parts["motor"] = {"kind": "shaft"}
        moves["reducer"] = {"kind": "reducer", "driver": "motor", "driven": "input", "ratio": 9}
        tolerances["reducer play"] = {
            "kind": "reducer_backlash",
            "of": "reducer",
            "distribution": {"kind": "uniform", "lower": "1 arcmin", "upper": "4 arcmin"},
        }
        first = "motor"
    return {
        "scene": "random train",
        "parts": parts,
        "tolerances": tolerances,
        "moves": {**moves, "train": {"kind": "train", "driven": first, "output": "output"}},
        "measures": {
            "lost motion": {"kind": "lost_motion", "of": "train"},
            "in the midst": {"kind": "lost_motion", "of": "train", "shaft": "middle", "over": {"at": "10 deg"}},
            "second play": {"kind": "normal_backlash", "of": "mesh 1"},
        },
        "study": {"seed": int(rng.integers(1, 1000))},
    }
