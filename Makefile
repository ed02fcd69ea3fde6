# Two commands: `make demo` runs the main job, `make test` passes all tests.
# Both first install what is missing.

.PHONY: demo test lint tools test-tools

demo: tools
	cargo run --release --locked -- demo

test: test-tools
	cargo test --release --locked --workspace

lint:
	cargo fmt --all --check
	cargo clippy --release --locked --workspace --all-targets -- -D warnings
	cargo check --release --locked -p kirigami --no-default-features
	RUSTDOCFLAGS="-D warnings" cargo doc --release --locked --workspace --lib --no-deps

tools:
	scripts/install-tools

test-tools:
	scripts/install-tools tests
