# Two commands do all the set-up on a fresh machine: `make film` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: film test test-long gallery clean

film: $(VENV)/installed
	$(BIN)/sceneql render scenes/first.yaml -o first.mp4

test: $(VENV)/installed-test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports
	$(BIN)/mypy
	$(BIN)/python -m pytest -n auto --dist worksteal

test-long: $(VENV)/installed-test
	SCENEQL_FUZZ=1000000 $(BIN)/python -m pytest tests -k "fuzz"
	SCENEQL_LONG=1 $(BIN)/python -m pytest -n auto --dist worksteal
	@# Kernels that look at every index, compiled into a cache of their own.
	NUMBA_BOUNDSCHECK=1 SCENEQL_CACHE=$(VENV)/checked $(BIN)/python -m pytest -n auto --dist worksteal
	@# Kernels compiled by numba as it is, without what compiled/numba replaces of it; they have a cache of their own.
	SCENEQL_NUMBA=plain $(BIN)/python -m pytest -n auto --dist worksteal

gallery: $(VENV)/installed
	$(BIN)/sceneql gallery update

$(VENV)/installed: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("sceneql needs Python 3.11 or newer, this is %d.%d; try make PYTHON=python3.13" % sys.version_info[:2] if sys.version_info < (3, 11) else 0)'
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || { echo "this Python cannot make virtual environments; on Debian: sudo apt-get install python3-venv" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	@# An editable install leaves the bytecode to the first run, which may not be allowed to keep it.
	$(BIN)/python -m compileall -q sceneql renderers
	touch $@

$(VENV)/installed-test: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[test]"
	touch $@

clean:
	rm -rf $(VENV) build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
