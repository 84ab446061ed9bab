"""Makes a notebook of every example that is divided into cells by lines `# %%`.

    python notebooks.py            writes them next to the scripts
"""

import json
import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent


def cells_of(script):
    """The cells of a script: of text after `# %% [markdown]`, of code after `# %%`."""
    cells = []
    for part in ("\n" + script).split("\n# %%")[1:]:
        head, _, body = part.partition("\n")
        lines = body.strip("\n").splitlines()
        is_text = head.strip() == "[markdown]"
        if is_text:
            lines = [line.removeprefix("#").removeprefix(" ") for line in lines]
        cell = {"cell_type": "markdown" if is_text else "code", "id": f"cell-{len(cells) + 1}", "metadata": {}}
        if not is_text:
            cell |= {"execution_count": None, "outputs": []}
        cells.append(cell | {"source": [line + "\n" for line in lines[:-1]] + lines[-1:]})
    return cells


def notebook_of(script):
    """The text of the notebook, without results."""
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    whole = {"cells": cells_of(script), "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def notebooks():
    """Every notebook with its text."""
    scripts = {path: path.read_text("utf-8") for path in sorted(FOLDER.glob("*.py"))}
    return {
        path.with_suffix(".ipynb"): notebook_of(text) for path, text in scripts.items() if text.startswith("# %%")
    }


if __name__ == "__main__":
    for path, text in notebooks().items():
        path.write_text(text, "utf-8")
        print(path.name)
