# Two commands for a newcomer: `make demo` and `make test`. Both set themselves up.
PYTHON ?= python3
BIN := .venv/bin
export PATH := $(CURDIR)/$(BIN):$(PATH)

.PHONY: demo test drill notebooks site lock clean

demo: .venv/ready
	@$(BIN)/python -m autograder.demo --out out/demo

test: .venv/ready
	$(BIN)/python -m pytest -n auto -m "not drill"

drill: .venv/ready
	$(BIN)/python -m pytest -n auto -m drill

notebooks: .venv/ready
	$(BIN)/python notebooks/build.py

site: .venv/ready
	@$(BIN)/python docs/site/build.py

.venv/ready: requirements.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check uv
	$(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python --require-hashes -r requirements.lock
	$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --no-build-isolation --editable .
	@touch $@

# The lock holds exact versions and hashes for every system, and no addresses; of it, what students need.
LOCK := --quiet --universal --python-version 3.11 --no-annotate --no-header --no-emit-index-url --no-emit-find-links
lock:
	$(BIN)/uv pip compile $(LOCK) --generate-hashes --extra instructor --extra cluster --extra dev --extra site \
	    pyproject.toml --output-file requirements.lock
	$(BIN)/uv pip compile $(LOCK) --extra student --constraint requirements.lock \
	    pyproject.toml --output-file requirements-student.txt

clean:
	rm -rf .venv out build *.egg-info .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
