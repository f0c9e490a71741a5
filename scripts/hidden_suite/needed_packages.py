"""Imported first by the scripts that users start: a missing package is one sentence, no traceback."""
import importlib.util
import pathlib
import sys

missing = [name for name in ("numpy", "scipy", "h5py") if importlib.util.find_spec(name) is None]
if missing:
    print(f"{pathlib.Path(sys.argv[0]).stem}: {sys.executable} lacks {', '.join(missing)}; "
          f"Debian: apt-get install {' '.join('python3-' + name for name in missing)}", file=sys.stderr)
    sys.exit(2)
