# Repose. `make help` lists the targets.
.DEFAULT_GOAL := all
.DELETE_ON_ERROR .SUFFIXES:

B       := build
T       := $(B)/tables
JOBS    ?= $(shell nproc)
# Where no locale is set, gnuplot warns of a degree sign.
export LC_ALL := C.UTF-8
CC      := gcc
CFLAGS  := -std=c11 -O3 -ffp-contract=off -fno-math-errno -pthread -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes \
           -Wmissing-prototypes -Wconversion -Werror=switch-enum -Wno-sign-conversion \
           -Wno-missing-field-initializers $(if $(SAN),,-fstack-protector-strong -fPIE) $(WERROR) $(SAN)
CPPFLAGS := -D_GNU_SOURCE -Isrc -I. $(if $(SAN),,-D_FORTIFY_SOURCE=2)
# Debian packages, for `setup`: those of the program and its figures, and those of what else is asked for in the same call.
# Work waits for `setup` then, and so pkg-config runs inside recipes.
PACKAGES := pkg-config libgsl-dev libconfig-dev libsqlite3-dev librandom123-dev libsuitesparse-dev libxxhash-dev \
            libjansson-dev gnuplot-nox fonts-dejavu-core pngquant
PACKAGES += $(if $(filter check% asan test lint validate report drill changes mutate analyze,$(MAKECMDGOALS)),libcunit1-dev \
            g++ clang-format python3 sqlite3)
PACKAGES += $(if $(filter manual deb check-deb,$(MAKECMDGOALS)),pandoc) $(if $(filter deb check-deb,$(MAKECMDGOALS)),build-essential debhelper) $(if $(filter check-deb,$(MAKECMDGOALS)),lintian)
SETUP_FIRST := $(filter setup setup-peers,$(MAKECMDGOALS))
PKGS     := gsl libconfig sqlite3 libxxhash jansson
$(if $(filter setup% help clean uninstall,$(MAKECMDGOALS))$(shell pkg-config --exists $(PKGS) 2>/dev/null && echo y),,$(error packages are missing: `make setup` installs them))
LIBS      = $$(pkg-config --libs $(PKGS)) -lcholmod -lm $(if $(SAN),,-pie -Wl,-z,relro,-z,now)
# module=prefix of its exported names; dependents before what they depend on. A module's rooms stand in tests/rooms.txt.
MODULES := sweep=sweep_ run=run_ view=view_ export=export_ exp=exp_ analytic=an_ dem=dem_ statics=statics_ angle=ang_ stress=stress_ stats=stats_ core=rp_
module   = $(word 1,$(subst =, ,$(1)))
ROOMS   := $(shell awk '{ print $$1 "=" $$2 }' tests/rooms.txt)
rooms    = $(patsubst $(1)=%,%,$(filter $(1)=%,$(ROOMS)))
objects  = $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(1:%=%/*.c)))
# A room's texts (.cfg) become part of its library, as sweep_text_NAME.
texts    = $(patsubst %.cfg,$(B)/obj/%.cfg.o,$(wildcard $(1:%=%/*.cfg)))
sources  = $(call objects,$(call rooms,$(call module,$(1)))) $(call texts,$(call rooms,$(call module,$(1))))
LIBRARY := $(foreach m,$(MODULES),$(B)/lib$(call module,$(m)).a)
CLI     := $(call objects,$(call rooms,cli))
REPORTER := $(call objects,report)
# The command line but the program itself and its commands.
FRAME   := $(filter-out %/cli/repose.o,$(call objects,$(filter-out src/cli/commands src/cli/derive,$(call rooms,cli))))
FUZZ    := $(call objects,tests/fuzz) $(filter-out %/cli/repose.o,$(CLI)) $(filter-out %/report/main.o,$(REPORTER))
CHECK   := $(call objects,tests) $(call objects,validation) $(FUZZ)
# A program of the core alone: libm and xxhash are all that it links, and Random123 has headers only.
ALONE   := $(patsubst %.c,$(B)/obj/%.o,$(filter %.c,$(wildcard $(shell awk '$$3 == "core" { print $$2, $$2 ".c", $$2 "/*.c" }' tests/rooms.txt))))
ALL     := $(CLI) $(REPORTER) $(foreach m,$(MODULES),$(call sources,$(m)))
REPOSE  := $(B)/repose
REPORT  := $(B)/report
.PHONY: all figures bench report check test validate asan lint sizes standalone setup setup-peers help clean FORCE
all: | $(SETUP_FIRST) ## build the programs: build/repose, and build/report, which makes the report
	@$(MAKE) --no-print-directory $(if $(filter -j%,$(MAKEFLAGS)),,-j$(JOBS)) $(REPOSE) $(REPORT)
help: ## this list
	@sed -n 's/^\([a-z][a-z-]*\):.*## /  \1\t/p' $(MAKEFILE_LIST) | expand -t 16
	@echo '  fig-NAME    one figure, as in `make fig-lh3`'
setup: ## install the Debian packages that are missing: make setup all, setup figures, setup check, setup deb
	@sh tests/setup.sh $(PACKAGES)
setup-peers: ## what some tests compare with, and else leave out: LAMMPS, VTK, pandas
	@sh tests/setup.sh lammps python3-vtk9 python3-pandas

# ---- The program and its tests
$(B)/obj/%.o: %.c | $(SETUP_FIRST)
	@mkdir -p $(@D) && echo "compile $<"
	@$(CC) $(CPPFLAGS) $$(pkg-config --cflags $(PKGS)) $(CFLAGS) -MMD -MP -c $< -o $@
# To compile tests at -O3 takes longer than it saves when they run.
$(call objects,tests validation): CFLAGS += $(if $(SAN),-O0,-O1)
$(B)/obj/%.cfg.o: %.cfg
	@mkdir -p $(@D) && echo "embed   $<"
	@printf '.section .rodata\n.global sweep_text_$(*F)\nsweep_text_$(*F): .incbin "$<"\n.byte 0\n.section .note.GNU-stack\n' | $(CC) -c -x assembler - -o $@
-include $(patsubst %.o,%.d,$(ALL) $(CHECK) $(ALONE) $(B)/obj/examples/core.o)
# The commit is part of every table's provenance: rebuild that one file when it changes. Tables that a study has just
# written do not make the program another one.
$(B)/commit: FORCE
	@mkdir -p $(@D); c=$$(grep -v Format .commit 2>/dev/null || git describe --always 2>/dev/null || echo unknown); \
	[ ! -e .git ] || git diff --quiet HEAD -- . ':!results' || c=$$c-dirty; \
	[ "$$c" = "$$(cat $@ 2>/dev/null)" ] || echo "$$c" > $@
# So are the sources of what a run yields: their text without comments and blanks makes the model of a store.
PHYSICS := $(sort $(wildcard $(foreach d,$(call rooms,dem) $(call rooms,exp) $(call rooms,angle) $(call rooms,statics) sweeps/protocols, \
           $(d) $(d)/*.[ch] $(d)/*.inl)) $(wildcard src/core/random.* src/core/elementary.* src/params/expression.* src/stats/series.*))
PHYSICS := $(filter %.c %.h %.inl,$(PHYSICS))
$(B)/sources: FORCE
	@mkdir -p $(@D); h=$$(cat $(PHYSICS) | LC_ALL=C sed -zE 's:/\*([^*]|\*+[^*/])*\*+/::g; s/[[:space:]]+//g' | sha256sum | head -c 16); \
	[ "$$h" = "$$(cat $@ 2>/dev/null)" ] || echo $$h > $@
$(B)/obj/src/core/version.o: $(B)/commit $(B)/sources
$(B)/obj/src/core/version.o: CPPFLAGS += '-DRP_COMMIT="$(shell cat $(B)/commit 2>/dev/null)"' \
	'-DRP_SOURCES="$(shell cat $(B)/sources 2>/dev/null)"' '-DRP_FLAGS="$(filter -std=% -O% -f% -m%,$(CFLAGS))"'

.SECONDEXPANSION:
$(B)/libframe.a: $(FRAME)
$(LIBRARY): $(B)/lib%.a: $$(call sources,%)
$(LIBRARY) $(B)/libframe.a:
	@rm -f $@ && ar qcs $@ $^
$(REPOSE): $(CLI) $(LIBRARY)
$(REPORT): $(REPORTER) $(B)/libframe.a $(LIBRARY)
$(B)/check: $(CHECK) $(LIBRARY) | $(if $(findstring fuzzer,$(SAN)),,$(B)/core)
$(REPOSE) $(REPORT) $(B)/check:
	@echo "link    $@" && $(CC) $(CFLAGS) $^ $(if $(filter %/check,$@),$$(pkg-config --libs cunit)) $(LIBS) -o $@

lint: $(LIBRARY) $(REPOSE) $(REPORT) $(B)/check ## check the order of layers, prefixes of modules, tables of figures, clang-format
	@sh tests/lint.sh $(B) $(MODULES)
standalone: $(B)/core ## build/core: a pile of grains, from examples/core.c and the core only
$(B)/libalone.a: $(ALONE)
	@rm -f $@ && ar qcs $@ $^
$(B)/core: $(B)/obj/examples/core.o $(B)/libalone.a
	@echo "link    $@" && $(CC) $(CFLAGS) $^ -lxxhash -lm $(if $(SAN),,-pie) -o $@
sizes: ## count lines, code and semicolons of each layer, and of core, tools and papers
	@python3 -B tests/sizes.py
# Figures that take no time show the tests the whole way from a model to a picture. The plain tests run beside the others,
# and print last: CUnit's summary is then what `make check` ends with. Background jobs of a shell ignore signals that tests send.
check: | $(SETUP_FIRST) ## unit tests and fast validation, with sanitizers and without
	@$(MAKE) --no-print-directory -j$(JOBS) $(REPOSE) $(REPORT) $(B)/check $(addprefix $(B)/figures/,li13.svg li14.svg li18.svg li19.svg)
	@REPOSE=$(REPOSE) env --default-signal=INT,QUIT $(B)/check -j$(JOBS) >$(B)/check.log 2>&1 & plain=$$!; \
	trap 'kill $$plain; exit 1' INT TERM; $(MAKE) --no-print-directory lint analyze-readers asan; others=$$?; wait $$plain; plain=$$?; \
	echo "check   plain"; cat $(B)/check.log; [ $$others$$plain = 00 ] || { echo "check   failed" >&2; exit 1; }
# Most of a short process would be its start: fixed addresses and static sanitizers need few relocations.
SANITIZE := -fsanitize=address,undefined -fno-sanitize-recover=all -static-libasan -static-libubsan -fno-pie -no-pie -g1 -O2 -ftrivial-auto-var-init=pattern
asan: | $(SETUP_FIRST) ## the same tests under the address and undefined-behaviour sanitizers
	@$(MAKE) --no-print-directory -j$(JOBS) B=$(B)/asan SAN='$(SANITIZE)' $(addprefix $(B)/asan/,check repose report)
	@echo "check   with sanitizers" && REPOSE=$(B)/asan/repose RP_CHECK_FAST=1 env --default-signal=INT,QUIT $(B)/asan/check -j$(JOBS)
test: $(B)/check $(REPOSE) $(REPORT) ## run some tests: make test SUITE=dem TEST='part of a name'
	@REPOSE=$(REPOSE) $(B)/check -j$(JOBS) $(SUITE) --test '$(TEST)'

# ---- A sweep, a suite or results fill a folder of tables, a figure names its sweeps, the report reads all.
# Sweeps of the papers, made by `make figures`; those of days, whose tables stand in results; suites of validation.
SWEEPS  := $(basename $(notdir $(wildcard sweeps/lh/*.cfg sweeps/li/*.cfg)))
STUDIES := $(basename $(notdir $(wildcard sweeps/studies/*.cfg sweeps/val/*.cfg) $(shell grep -l 'study *=' sweeps/l[hi]/*.cfg)))
SUITES  := $(filter-out $(basename $(notdir $(wildcard validation/*.h))),$(basename $(notdir $(wildcard validation/*.c))))
FIGURES := $(basename $(notdir $(wildcard figures/l[hi]/*.gp figures/studies/*.gp)))
CHECKED := $(filter-out bench,$(basename $(notdir $(wildcard figures/val/*.gp))))
PAGES   := paper-repro $(addprefix docs/,claims choices beyond misprints validation)
# Small pictures that paper-repro.md, README and docs show.
SHOWN   := $(sort $(notdir $(shell grep -oh 'figures/shown/[a-z0-9_]*' report/text/paper-repro.md.in README.md docs/*.md)))
# Tables are stale when any code but the commit's name has changed.
CODE    := $(filter-out %/version.o $(REPORTER),$(ALL)) | $(REPOSE)
vpath %.cfg sweeps/lh sweeps/li sweeps/studies sweeps/val
vpath %.gp figures/lh figures/li figures/studies figures/val
$(SWEEPS:%=$(T)/%/done): $(T)/%/done: %.cfg $(CODE)
	@echo "sweep   $*"
	@$(REPOSE) sweep make $< -o $(B)/sweeps/$* --tables $(@D) -j $(JOBS)
	@touch $@ && echo "sweep   $* is made, $$(ls $(SWEEPS:%=$(T)/%/done) 2>/dev/null | wc -l) of $(words $(SWEEPS)) are"
$(SUITES:%=$(T)/%/done): $(T)/%/done: validation/%.c $(CODE) $(B)/check
	@echo "check   --full $*"; mkdir -p $(@D); REPOSE=$(REPOSE) $(B)/check --full -o $(T) $* >$(@D)/log || { cat $(@D)/log; exit 1; }; touch $@
$(T)/claims/done: report/claims.tsv results/lh_drop/points.tsv results/lh_ramp/points.tsv $(REPORTER) | $(REPORT)
	@mkdir -p $(@D) && cp $< $(@D)/published.tsv
	@for t in drop ramp; do $(REPORT) joint --claims $< --table lh_$$t/points >$(@D)/$$t.tsv || exit 1; done
	@$(REPORT) joint --id lh-five/four --claims $< --table lh_drop/points >$(@D)/drop_four.tsv && $(REPORT) joint --id lh-five/four --claims $< --table lh_ramp/points >$(@D)/ramp_four.tsv && touch $@
$(T)/%/done: results/%/points.tsv
	@mkdir -p $(@D) && ln -sfr results/$*/*.tsv $(@D) && touch $@
# "# sweeps: lh3 lh3_box" and "load 'FILE'" in a figure's file become its dependencies, and so do tables in results.
$(B)/figures.mk: $(wildcard figures/*/*.gp)
	@mkdir -p $(B) && awk -F "[ ']+" '{ f = FILENAME; gsub(".*/|[.]gp$$", "", f) } /^load / { print "$(B)/figures/" f ".svg: " $$2 } \
	  /^# sweeps:/ { for (i = 3; i <= NF; i++) print "$(B)/figures/" f ".svg: $(T)/" $$i "/done $$(wildcard results/" $$i "/*.tsv)" }' $^ >$@
-include $(B)/figures.mk
# As SVG, PDF and PNG, and for pages with the dots an inch and colours that take at most 80 kB, of the piles that the words
# are of: tables in results come before those just made.
draw = gnuplot -e "folders='$(1)'; sweeps='$$(sed -n 's/^. sweeps: //p' $<)'; terminal='$$t'; file='$(basename $@)'" figures/style.gp $<
$(B)/figures/%.svg: %.gp figures/style.gp figures/chains.gp | $(SETUP_FIRST)
	@mkdir -p $(@D) && for t in pdf png svg; do $(call draw,$(T)) || exit 1; done && echo "figure  $*"
$(B)/figures/shown/%.png: %.gp $(B)/figures/%.svg
	@mkdir -p $(@D) && for t in svg shown; do $(call draw,results $(T)) || exit 1; done; for n in 64 16; do pngquant --force --nofs --output $@ $$n $@ && [ $$(stat -c %s $@) -gt 80000 ] || break; done
fig-%: $(B)/figures/%.svg
	@echo "$(B)/figures/$*.svg .pdf .png"
make_pages = mkdir -p $(B)/docs; for p in $(PAGES); do \
	$(REPORT) page report/text/$$(basename $$p).md.in --tables $$tables -o $(B)/$$p.md || exit 1; done
make_html = sh report/page/page.sh $(REPOSE) $(B)
# Two sweeps at a time, each on all cores: where one ends and derives its tables, the other works.
figures: | $(SETUP_FIRST) ## make every figure of the two papers and of the studies, into build/figures, and build/paper-repro.md
	@$(MAKE) -s -j$(JOBS) $(REPOSE) $(REPORT)
	@$(MAKE) -s -j2 $(SWEEPS:%=$(T)/%/done)
	@$(MAKE) -s -Oline -j$(JOBS) $(FIGURES:%=$(B)/figures/%.svg) $(patsubst %,$(B)/figures/shown/%.png,$(filter $(FIGURES),$(SHOWN)))
	@tables=results,$(T),results/kept; $(make_pages); echo "report  $(B)/paper-repro.md"
validate: $(REPOSE) $(B)/check ## validation at full size, with tables and figures
	@$(MAKE) -s -j1 $(SUITES:%=$(T)/%/done) $(CHECKED:%=$(B)/figures/%.svg)
report: figures validate $(SHOWN:%=$(B)/figures/shown/%.png) ## make paper-repro.md, pages of docs and the pictures that they show; build/report.html, with pandoc
	@sh report/keep.sh $(T); tables=results,results/kept; $(make_pages); for p in $(PAGES); do cp $(B)/$$p.md $$p.md; done
	@cp $(SHOWN:%=$(B)/figures/shown/%.png) figures/shown && $(make_html)
	@[ ! -e .git ] || git --no-pager diff --exit-code --stat HEAD -- $(PAGES:=.md) results || \
	  { echo "report: these differ from the last commit; look at them (git diff), and commit them" >&2; exit 1; }
include tests/longer.mk install.mk src/page/page.mk
.PRECIOUS: $(T)/%/done
clean: ## remove everything that was made
	rm -rf $(B)
