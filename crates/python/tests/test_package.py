"""The package as it is installed: what it takes to import it, and what it says of itself."""

import importlib.metadata
import pathlib
import subprocess
import sys

import bilux


def test_importing_takes_little_beyond_numpy():
    script = """
from time import process_time
begun = process_time()
import numpy
between = process_time()
import bilux
print((process_time() - between) / (between - begun))
"""
    parts = [float(subprocess.check_output([sys.executable, "-c", script])) for _ in range(5)]
    print(f"import bilux: {min(parts):.3f} of the CPU seconds that numpy takes")
    assert min(parts) < 0.25


def test_nothing_but_numpy_is_imported():
    script = "import sys, bilux; print(' '.join({name.split('.')[0] for name in sys.modules}))"
    modules = subprocess.check_output([sys.executable, "-c", script], text=True).split()
    assert "numpy" in modules and not {"trimesh", "tqdm", "scipy", "ray", "matplotlib"} & set(modules)


def test_the_package_says_which_version_it_is():
    try:
        assert importlib.metadata.version("bilux") == bilux.__version__
    except importlib.metadata.PackageNotFoundError:
        # Run from its folder, without having been installed.
        assert bilux.__version__.count(".") == 2
    assert "pyo3" in bilux.licenses()
    assert (pathlib.Path(bilux.__file__).parent / "py.typed").is_file()
