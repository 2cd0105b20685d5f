# Two commands do all the set-up on a fresh machine: `make film` and `make test`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

# Bytecode is kept, whatever the shell says: else each process of the suite compiles all tests anew, for 7 s.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: film test test-long test-fuzz test-whole test-checked test-plain gallery clean

film: $(VENV)/installed
	$(BIN)/sceneql render scenes/first.yaml -o first.mp4

test: $(VENV)/installed-test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports
	@# Where mypy has to read all, it takes one core for a tenth of the suite's time: it runs beside, and tells at the end.
	$(BIN)/mypy > $(VENV)/mypy.log 2>&1 & types=$$!; trap "kill $$types" INT TERM; \
	$(BIN)/python -m pytest -n auto --dist worksteal; suite=$$?; \
	wait $$types; types=$$?; cat $(VENV)/mypy.log; test $$suite -eq 0 && test $$types -eq 0

# Each part ends and tells by itself, and may be begun alone; FUZZ and SEED choose how much is tried, and which.
FUZZ ?= 20000
SEED ?= 0
SUITE := $(BIN)/python -m pytest -n auto --dist worksteal --maxfail 20

test-long: test-fuzz test-whole test-checked test-plain

test-fuzz: $(VENV)/installed-test
	SCENEQL_FUZZ=$(FUZZ) SCENEQL_SEED=$(SEED) $(SUITE) tests -k "fuzz"

test-whole: $(VENV)/installed-test
	SCENEQL_LONG=1 $(SUITE)

# Kernels that look at every index, compiled into a cache of their own.
test-checked: $(VENV)/installed-test
	NUMBA_BOUNDSCHECK=1 SCENEQL_CACHE=$(VENV)/checked $(SUITE)

# Kernels compiled by numba as it is, without what compiled/numba replaces of it; they have a cache of their own.
test-plain: $(VENV)/installed-test
	SCENEQL_NUMBA=plain $(SUITE)

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
