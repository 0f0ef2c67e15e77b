# The front door: each target installs what is missing, builds and works when it is run first.
# Under it stand plain CMake presets (`cmake --list-presets`); use them freely.

PREFIX ?= /usr/local
DESTDIR ?=
export DESTDIR

MAKEFLAGS += --no-print-directory
.SILENT:
.DEFAULT_GOAL := help
.PHONY: help build demo test test-full lint gallery install clean

help:
	echo 'make build      the program, at build/release/bin/sightline'
	echo 'make demo       render the sample models into out/demo/'
	echo 'make test       every test, also under sanitizers, and a short fuzz run'
	echo 'make test-full  the same with the heavy cases, the thread sanitizer and longer fuzzing'
	echo 'make lint       format, static analysis, and what the compiler makes of hot loops'
	echo 'make gallery    draw the pictures of docs/gallery/ and docs/algorithms/ anew'
	echo 'make install    into PREFIX (default /usr/local), below DESTDIR if that is set'
	echo 'make clean      remove build/ and out/'

build:
	scripts/install-deps.sh build
	scripts/build.sh

demo: build
	scripts/run-readme.sh out/demo
	echo 'The pictures are in out/demo/:'
	ls out/demo/*.png

gallery: build
	scripts/run-readme.sh docs/gallery
	scripts/run-readme.sh docs/drawings docs/drawings.md
	scripts/run-readme.sh docs/plots docs/plots.md
	scripts/draw-algorithms.sh docs/algorithms
	echo 'The pictures of docs/gallery/, docs/drawings/, docs/plots/ and docs/algorithms/ are new.'

test:
	scripts/test.sh

test-full:
	scripts/test.sh --full

lint:
	scripts/lint.sh

install: build
	cmake --install build/release --prefix '$(PREFIX)' >/dev/null
	echo 'Installed $(DESTDIR)$(PREFIX)/bin/sightline, the library and its documents.'

clean:
	rm -rf build out
