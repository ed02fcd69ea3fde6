# Two commands: `make demo` runs the main job, `make test` passes all tests.
# Both first install what is missing.

.PHONY: demo test test-fast lint paper built page python python-torch tools test-tools python-tools

# With the features of the whole workspace, so that `make test` compiles no dependency again.
demo: built
	target/release/kirigami demo

test: test-tools
	cargo test --release --locked --workspace

# The tests that need no external program: no gmsh, CalculiX, Slurm, browser, strace or ezdxf.
test-fast:
	cargo test --release --locked --workspace --lib --bins --test command_line --test data \
	    --test measured_sheet --test reference --test run --test scenes --test sheet --test tensile --test vtk_sheet --test weights

# The oldest Rust that Cargo.toml allows compiles the workspace; where it is the installed one nothing is compiled again.
lint:
	cargo fmt --all --check
	cargo clippy --release --locked --workspace --all-targets -- -D warnings
	cargo check --release --locked -p kirigami --no-default-features
	RUSTDOCFLAGS="-D warnings" cargo doc --release --locked --workspace --lib --no-deps

# The figures of docs/PAPER.md that commands of the program print, with the paper's, in some minutes.
paper: built
	scripts/paper

# The studio as a folder of files for any web server: no request leaves the page. rustup adds the target.
page:
	rustup target add wasm32-wasip1
	RUSTFLAGS="-C target-feature=+simd128" cargo rustc --locked --profile page -p studio --lib \
	    --target wasm32-wasip1 --crate-type cdylib
	rm -rf target/page
	cargo run --release --locked -- studio --page target/page
	cp target/wasm32-wasip1/page/studio.wasm target/page/kirigami.wasm
	cargo test --release --locked -p kirigami --test end_to_end static_page -- --ignored

# The Python package and its tests, in an environment of their own. The tests of PyTorch need 5 GB: by a command of their own.
python: python-tools
	python3 -m venv target/python
	target/python/bin/pip install --quiet -r python/tests/requirements.txt ./python
	target/python/bin/pytest python

python-torch: python
	target/python/bin/pip install --quiet './python[torch]'
	target/python/bin/pytest python/tests/test_torch.py

built: tools
	cargo build --release --locked --workspace --bin kirigami

tools:
	scripts/install-tools

test-tools:
	scripts/install-tools tests

python-tools:
	scripts/install-tools python

# The pages as a site, target/book/index.html; installs mdBook, in some minutes, if it is missing.
.PHONY: book
book:
	scripts/book
