# Repose. `make help` lists the targets.
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

B       := build
JOBS    ?= $(shell nproc)
CC      := gcc
WERROR  :=
SAN     :=
CFLAGS  := -std=c11 -O3 -ffp-contract=off -fno-math-errno -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes \
           -Wmissing-prototypes -Wconversion -Wno-sign-conversion $(WERROR) $(SAN)
CPPFLAGS := -D_GNU_SOURCE -Isrc -I.

# Debian packages that the project needs, for `setup`.
PACKAGES := pkg-config libgsl-dev libnlopt-dev libcunit1-dev gnuplot-nox libconfig-dev libsqlite3-dev \
            librandom123-dev libsuitesparse-dev libxxhash-dev fonts-dejavu-core
# pkg-config runs inside the recipes, so that `make setup figures` works in one call.
PC       := pkg-config
PKGS     := gsl libconfig sqlite3 libxxhash
LIBS      = $$($(PC) --libs $(PKGS)) -lm
INCLUDES  = $$($(PC) --cflags $(PKGS))

# Whatever compiles waits for `setup` when both are asked for.
SETUP_FIRST := $(filter setup,$(MAKECMDGOALS))

MODULES := core analytic dem angle sweep
DIR_core := src/core
DIR_analytic := analytic
DIR_dem := src/dem
DIR_angle := src/angle
DIR_sweep := sweeps
PREFIX_core := rp_
PREFIX_analytic := an_
PREFIX_dem := dem_
PREFIX_angle := ang_
PREFIX_sweep := sweep_

objects  = $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(1)/*.c))
ARCHIVES := $(MODULES:%=$(B)/lib%.a)
# dependents before what they depend on
LINKED   := $(B)/libsweep.a $(B)/libanalytic.a $(B)/libdem.a $(B)/libangle.a $(B)/libcore.a
CLI      := $(call objects,src/cli)
CHECK    := $(call objects,tests) $(call objects,validation)

.PHONY: all figures check asan lint setup help clean report FORCE
all: $(B)/repose ## build the program, build/repose

help: ## this list
	@sed -n 's/^\([a-z][a-z-]*\):.*## /  \1\t/p' $(MAKEFILE_LIST) | expand -t 14
	@echo '  fig-NAME    one figure, as in `make fig-lh3`'

setup: ## install the Debian packages that are missing
	@missing=; for p in $(PACKAGES); do \
	  dpkg-query -W -f '$${Status}\n' $$p 2>/dev/null | grep -q 'install ok installed' || missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then \
	  if [ "$$(id -u)" = 0 ]; then sudo=; elif command -v sudo >/dev/null; then sudo=sudo; else \
	    echo "setup: as root, run: apt-get install$$missing" >&2; exit 1; fi; \
	  echo "setup: installing$$missing"; \
	  $$sudo apt-get update -q >/dev/null && \
	  $$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $$missing >/dev/null; fi

$(B)/obj/%.o: %.c | $(SETUP_FIRST)
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(INCLUDES) $(CFLAGS) -MMD -MP -c $< -o $@

# The commit is part of every table's provenance: rebuild that one file when it changes.
$(B)/commit: FORCE
	@mkdir -p $(@D)
	@c=$$(git describe --always --dirty 2>/dev/null || echo unknown); \
	[ "$$c" = "$$(cat $@ 2>/dev/null)" ] || echo "$$c" > $@
$(B)/obj/src/core/version.o: $(B)/commit
$(B)/obj/src/core/version.o: CPPFLAGS += '-DRP_COMMIT="$(shell cat $(B)/commit 2>/dev/null)"' \
	'-DRP_FLAGS="$(filter -std=% -O% -f%,$(CFLAGS))"'

define archive
$(B)/lib$(1).a: $(call objects,$(DIR_$(1)))
	@rm -f $$@
	@ar rcs $$@ $$^
endef
$(foreach m,$(MODULES),$(eval $(call archive,$(m))))

$(B)/repose: $(CLI) $(LINKED)
	$(CC) $(CFLAGS) $^ $(LIBS) -o $@

$(B)/check: $(CHECK) $(LINKED)
	$(CC) $(CFLAGS) $^ $$($(PC) --libs cunit) $(LIBS) -o $@

-include $(patsubst %.o,%.d,$(CLI) $(CHECK) $(foreach m,$(MODULES),$(call objects,$(DIR_$(m)))))

lint: $(ARCHIVES) ## the modules' borders: who includes whom, which prefix is exported
	@sh tests/lint.sh $(B) $(foreach m,$(MODULES),$(m)=$(DIR_$(m))=$(PREFIX_$(m)))

check: lint asan $(B)/check $(B)/repose ## unit tests and fast validation, plain and with sanitizers
	@REPOSE=$(B)/repose $(B)/check

asan: | $(SETUP_FIRST) ## the same tests under the address and undefined-behaviour sanitizers
	@$(MAKE) --no-print-directory B=build/asan SAN='-fsanitize=address,undefined -fno-sanitize-recover=all -g -O1' \
	  build/asan/check build/asan/repose
	@REPOSE=build/asan/repose RP_CHECK_FAST=1 build/asan/check

clean: ## remove everything made
	rm -rf $(B)
