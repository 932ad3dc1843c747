"""Parts of numpy that are loaded by who uses them."""

import subprocess
import sys

CODE = """
import sys, numpy as np
from tol3d.numerics.seldom import load_when_used
load_when_used()
import scipy.special
print("numpy.f2py.f2py2e" in sys.modules, "numpy.ma.core" in sys.modules, float(scipy.special.ndtri(0.5)))
print(float(np.ma.masked_invalid([1.0, np.nan, 3.0]).mean()), "numpy.ma.core" in sys.modules)
before = np.ma
load_when_used()
print(np.ma is before, callable(np.testing.assert_allclose))
"""


def test_parts_of_numpy_load_when_something_of_theirs_is_asked_for() -> None:
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["False False 0.0", "2.0 True", "True True"]
