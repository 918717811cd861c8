# The commands people and CI run. `just` lists them.

default:
    @just --list

# Format, lint, test and run the main job, as CI does.
ci:
    bash .ci/run

# Run all tests.
test:
    cargo test --release

# The main job: data-samples in, report out.
main:
    cargo run --release -- run

# Lint with warnings as errors.
lint:
    cargo fmt --check
    cargo clippy --release --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps

# Benchmarks (ratios in one run).
bench:
    cargo bench

# Shards on a Slurm of our own on the loopback address (as root, with slurm-wlm and munge installed).
slurm:
    contrib/slurm/test.sh

# Instructions of fixed models against their budget (valgrind).
instructions:
    cargo build --release
    python3 benches/instructions.py
