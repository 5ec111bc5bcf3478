# Repose. `make help` lists the targets.
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

B       := build
T       := $(B)/tables
JOBS    ?= $(shell nproc)
CC      := gcc
CFLAGS  := -std=c11 -O3 -ffp-contract=off -fno-math-errno -pthread -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes \
           -Wmissing-prototypes -Wconversion -Werror=switch-enum -Wno-sign-conversion \
           -Wno-missing-field-initializers $(if $(SAN),,-fstack-protector-strong -fPIE) $(WERROR) $(SAN)
CPPFLAGS := -D_GNU_SOURCE -Isrc -I. $(if $(SAN),,-D_FORTIFY_SOURCE=2)

# Debian packages that the project needs, for `setup`.
PACKAGES := g++ pkg-config libgsl-dev libnlopt-dev libcunit1-dev gnuplot-nox libconfig-dev libsqlite3-dev \
            librandom123-dev libsuitesparse-dev libxxhash-dev libjansson-dev zlib1g-dev fonts-dejavu-core pngquant \
            clang-format python3 python3-pandas lammps
# pkg-config runs inside the recipes, so that `make setup figures` works in one call.
PKGS     := gsl nlopt libconfig sqlite3 libxxhash jansson zlib
LIBS      = $$(pkg-config --libs $(PKGS)) -lcholmod -lm $(if $(SAN),,-pie -Wl,-z,relro,-z,now)
INCLUDES  = $$(pkg-config --cflags $(PKGS))
# Work waits for `setup` when both are asked for.
SETUP_FIRST := $(filter setup,$(MAKECMDGOALS))
# module=prefix of its exported names; dependents before what they depend on. A module's rooms stand in tests/rooms.txt.
MODULES := sweep=sweep_ view=view_ export=export_ analytic=an_ dem=dem_ statics=statics_ angle=ang_ stress=stress_ stats=stats_ core=rp_
module   = $(word 1,$(subst =, ,$(1)))
rooms    = $(shell awk '$$1 == "$(1)" { print $$2 }' tests/rooms.txt)
objects  = $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(1:%=%/*.c)))
sources  = $(call objects,$(call rooms,$(call module,$(1))))
LIBRARY := $(foreach m,$(MODULES),$(B)/lib$(call module,$(m)).a)
CLI     := $(call objects,$(call rooms,cli))
REPORTER := $(call objects,report)
# The frame of a program: all of the command line but the program itself and its commands.
FRAME   := $(filter-out %/cli/repose.o,$(call objects,$(filter-out src/cli/commands,$(call rooms,cli))))
FUZZ    := $(call objects,tests/fuzz) $(filter-out %/cli/repose.o,$(CLI)) $(filter-out %/report/main.o,$(REPORTER))
CHECK   := $(call objects,tests) $(call objects,validation) $(FUZZ)
ALL     := $(CLI) $(REPORTER) $(foreach m,$(MODULES),$(call sources,$(m)))
REPOSE  := $(B)/repose
REPORT  := $(B)/report

.PHONY: all figures studies checksums bench report check-report check test validate asan lint setup help clean FORCE
all: $(REPOSE) $(REPORT) ## build the programs: build/repose, and build/report, which makes the report

help: ## this list
	@sed -n 's/^\([a-z][a-z-]*\):.*## /  \1\t/p' $(MAKEFILE_LIST) | expand -t 16
	@echo '  fig-NAME    one figure, as in `make fig-lh3`'

setup: ## install the Debian packages that are missing
	@sh tests/setup.sh $(PACKAGES)

# ---- The program and its tests
$(B)/obj/%.o: %.c | $(SETUP_FIRST)
	@mkdir -p $(@D)
	@echo "compile $<"
	@$(CC) $(CPPFLAGS) $(INCLUDES) $(CFLAGS) -MMD -MP -c $< -o $@
-include $(patsubst %.o,%.d,$(ALL) $(CHECK))

# The commit is part of every table's provenance: rebuild that one file when it changes. Tables that a study has just
# written do not make the program another one.
$(B)/commit: FORCE
	@mkdir -p $(@D); c=$$(grep -v Format .commit 2>/dev/null || git describe --always 2>/dev/null || echo unknown); \
	[ ! -e .git ] || git diff --quiet HEAD -- . ':!results' || c=$$c-dirty; \
	[ "$$c" = "$$(cat $@ 2>/dev/null)" ] || echo "$$c" > $@
$(B)/obj/src/core/version.o: $(B)/commit
$(B)/obj/src/core/version.o: CPPFLAGS += '-DRP_COMMIT="$(shell cat $(B)/commit 2>/dev/null)"' \
	'-DRP_FLAGS="$(filter -std=% -O% -f% -m%,$(CFLAGS))"'

define archive
$(B)/lib$(call module,$(1)).a: $(call sources,$(1))
endef
$(foreach m,$(MODULES),$(eval $(call archive,$(m))))
$(B)/libframe.a: $(FRAME)
$(LIBRARY) $(B)/libframe.a:
	@rm -f $@ && ar qcs $@ $^

$(REPOSE): $(CLI) $(LIBRARY)
	@echo "link    $@"
	@$(CC) $(CFLAGS) $^ $(LIBS) -o $@

$(REPORT): $(REPORTER) $(B)/libframe.a $(LIBRARY)
	@echo "link    $@"
	@$(CC) $(CFLAGS) $^ $(LIBS) -o $@

$(B)/check: $(CHECK) $(LIBRARY)
	@echo "link    $@"
	@$(CC) $(CFLAGS) $^ $$(pkg-config --libs cunit) $(LIBS) -o $@

lint: $(LIBRARY) $(REPOSE) $(REPORT) ## order of the rooms, prefixes of the modules, tables of figures, clang-format
	@sh tests/lint.sh $(B) $(MODULES)

# Figures that take no time show the tests the whole way from a model to a picture. The plain tests run beside the others,
# and print last: CUnit's summary is then what `make check` ends with. Background jobs of a shell ignore signals that tests send.
check: | $(SETUP_FIRST) ## unit tests and fast validation, with sanitizers and plain
	@$(MAKE) --no-print-directory -j$(JOBS) $(REPOSE) $(REPORT) $(B)/check $(addprefix $(B)/figures/,li13.svg li14.svg li18.svg li19.svg)
	@REPOSE=$(REPOSE) env --default-signal=INT,QUIT $(B)/check -j$(JOBS) >$(B)/check.log 2>&1 & plain=$$!; \
	trap 'kill $$plain; exit 1' INT TERM; $(MAKE) --no-print-directory lint asan; others=$$?; wait $$plain; plain=$$?; \
	echo "check   plain"; cat $(B)/check.log; [ $$others$$plain = 00 ] || { echo "check   failed" >&2; exit 1; }

# Most of a short process would be its start: fixed addresses and static sanitizers need few relocations.
SANITIZE := -fsanitize=address,undefined -fno-sanitize-recover=all -static-libasan -static-libubsan -fno-pie -no-pie -g1 -O2
asan: | $(SETUP_FIRST) ## the same tests under the address and undefined-behaviour sanitizers
	@$(MAKE) --no-print-directory -j$(JOBS) B=$(B)/asan SAN='$(SANITIZE)' \
	  $(B)/asan/check $(B)/asan/repose $(B)/asan/report
	@echo "check   with sanitizers" && REPOSE=$(B)/asan/repose RP_CHECK_FAST=1 $(B)/asan/check -j$(JOBS)

test: $(B)/check $(REPOSE) $(REPORT) ## some tests: make test SUITE=dem TEST='part of a name'
	@REPOSE=$(REPOSE) $(B)/check -j$(JOBS) $(SUITE) --test '$(TEST)'

# ---- Sweeps and models -> tables -> figures and report
# Of the papers, each made by `make figures`; of studies, whose tables stand in results.
SWEEPS  := $(basename $(notdir $(wildcard sweeps/lh/*.cfg sweeps/li/*.cfg)))
STUDIES := $(basename $(notdir $(wildcard sweeps/studies/*.cfg sweeps/val/*.cfg)))
# These have larger ensembles too, which the report prefers.
STUDIED := $(STUDIES) $(foreach s,$(SWEEPS),$(if $(filter study,$(file <$(wildcard sweeps/*/$(s).cfg))),$(s)))
owner     = $(lastword $(sort $(foreach s,$(SWEEPS) $(STUDIES),$(if $(filter $(s) $(s)_% $(s)/%,$(1)),$(s)))))
# The files that a figure's file loads.
loads     = $(if $(1),$(sort $(shell sed -n "s/^load '\(.*\)'.*/\1/p" $(1))))
# A figure of a study is drawn where its tables are in results.
tables_of = $(foreach t,$(filter %.tsv,$(file <$(wildcard figures/*/$(1).gp))),$(if $(findstring ',$(t)),,$(t)))
lacks     = $(strip $(foreach t,$(call tables_of,$(1)),$(if $(filter $(STUDIES),$(call owner,$(t:.tsv=))),$(if $(wildcard results/$(t)),,$(t)))))
drawable  = $(foreach f,$(basename $(notdir $(wildcard $(1)))),$(if $(call lacks,$(f)),,$(f)))
FIGURES   = $(call drawable,figures/lh/*.gp figures/li/*.gp figures/studies/*.gp)
CHECKED   = $(filter-out bench,$(call drawable,figures/val/*.gp))
VALIDATION := $(filter-out $(basename $(notdir $(wildcard validation/*.h))),$(basename $(notdir $(wildcard validation/*.c))))
# A table is stale when any code but the commit's name has changed.
CODE    := $(filter-out %/version.o $(REPORTER),$(ALL)) | $(REPOSE)
vpath %.cfg sweeps/lh sweeps/li sweeps/val sweeps/studies

# Each core works on a sweep of its own; the longest come first.
LONGEST := lh5 lh2b lh_gamma lh3
# The report, and the pages behind it: report/text/NAME.md.in.
PAGES   := paper-repro $(addprefix docs/,claims choices beyond misprints validation)
make_pages = mkdir -p $(B)/docs; for p in $(PAGES); do \
	$(REPORT) page report/text/$$(basename $$p).md.in --tables $$tables -o $(B)/$$p.md || exit 1; done
# Pages hold tables of `make figures` and `make validate` too: results/kept has the small ones that they need, so that
# `make check` makes each page again. One is replaced where more than its making and its times differ.
KEPT    := $(filter-out validation_precision_%,$(notdir $(wildcard results/kept/*.tsv)))
numbers  = awk -F'\t' '/^\# (program|compiler|libraries|command|runs made by|run_time|commit):/ { next } /^\#/ { print; next } \
	!n { n = NF; for (k = 1; k <= n; k++) time[k] = $$k ~ /^(seconds|run_time)$$/ } { for (k in time) if (time[k]) $$k = ""; print }'
keep_tables = for t in $(KEPT); do [ "$$($(numbers) $(T)/$$t)" = "$$($(numbers) results/kept/$$t)" ] || cp $(T)/$$t results/kept || exit 1; done
# Each table of results stands a second time by its checksum, so that a number that is changed by hand is found.
sign_results = (cd results && sha256sum *.tsv kept/*.tsv | LC_ALL=C sort -k 2 >checksums.txt)
# Small pictures that paper-repro.md, README and docs show.
SHOWN   := $(sort $(notdir $(shell grep -oh 'figures/shown/[a-z0-9_]*' report/text/paper-repro.md.in README.md docs/*.md)))
figures: | $(SETUP_FIRST) ## every figure of the two papers and of the studies in results, into build/figures, and build/paper-repro.md
	@$(MAKE) -s -j$(JOBS) $(REPOSE) $(REPORT)
	@$(MAKE) -s -Oline -j$(JOBS) WORKERS=1 $(addprefix $(B)/made/,$(LONGEST) $(filter-out $(LONGEST),$(SWEEPS))) $(FIGURES:%=$(B)/figures/%.svg) \
	  $(patsubst %,$(B)/figures/shown/%.png,$(filter $(FIGURES),$(SHOWN)))
	@tables=results,$(T),results/kept; $(make_pages); echo "report  $(B)/paper-repro.md"

validate: $(REPOSE) $(B)/check ## the validation at full size, tables and figures
	@$(MAKE) -s -j1 $(VALIDATION:%=$(B)/validated/%) $(CHECKED:%=$(B)/figures/%.svg)

checksums: ## results/checksums.txt anew, where a table of results was replaced by hand
	@$(sign_results)

studies: $(STUDIED:%=$(B)/studied/%) ## larger ensembles, for days: their tables, into results; resumable

# Tables: NAME.tsv and NAME_*.tsv come from the sweep of the longest such name, and validation_SUITE_*.tsv from a suite.
suite  = $(firstword $(subst _, ,$(1:validation_%=%)))
source = $(if $(filter validation_%,$(1)),$(B)/validated/$(suite),$(if $(filter $(STUDIES),$(owner)),results/$(1).tsv,$(B)/made/$(owner)))
.SECONDEXPANSION:
$(T)/%.tsv: $$(call source,$$*)
	@$(if $(filter results/%,$<),mkdir -p $(@D) && ln -sfr $< $@)

WORKERS := $(JOBS)
make_sweep = echo "sweep   $*$(1)" && $(REPOSE) sweep make $< -o $(B)/sweeps/$* -j $(WORKERS)$(1) --tables
$(B)/made/%: %.cfg $(CODE)
	@$(make_sweep) $(T)
	@mkdir -p $(@D) && touch $@
$(B)/studied/%: %.cfg $(CODE)
	@$(call make_sweep, --study) $(B)/studies
	@mkdir -p $(@D) results
	@cp $$(ls $(B)/studies/$*.tsv $(B)/studies/$*_*.tsv | grep -v '_runs.tsv$$\|_row[0-9]*.tsv$$') results && $(sign_results) && touch $@
$(B)/studied/lh_size_large: $(B)/studied/lh_size $(B)/studied/lh_size_mid
$(B)/studied/lh2b_wide: $(B)/studied/lh2b_narrow
$(B)/studied/lh_rough_large: $(B)/studied/lh_rough
results/%.tsv:
	@echo "$@ is missing: make studies" >&2; exit 1
$(B)/validated/%: validation/%.c $(CODE) $(B)/check
	@mkdir -p $(@D) && echo "check   --full $*"
	@REPOSE=$(REPOSE) $(B)/check --full -o $(T) $* >$@.log || { cat $@.log; exit 1; }
	@touch $@
$(T)/published.tsv: report/claims.tsv $(REPORTER) | $(REPORT)
	@mkdir -p $(T) && $(REPORT) published --claims $< >$@

# A figure's file lists its tables after "# tables:".
$(patsubst %,$(B)/figures/%.svg,$(FIGURES) $(CHECKED) bench): $(B)/figures/%.svg: $$(wildcard figures/*/$$*.gp) $(wildcard figures/*.gp) $$(call loads,$$(wildcard figures/*/$$*.gp)) $$(addprefix $(T)/,$$(call tables_of,$$*)) | $(SETUP_FIRST)
	@mkdir -p $(@D)
	@for t in pdf png svg; do gnuplot -e "T='$(T)/'; tables='$(call tables_of,$*)'; terminal='$$t'; file='$(B)/figures/$*'" \
	  figures/style.gp $< || exit 1; done
	@echo "figure  $*"
fig-%: $(B)/figures/%.svg
	@echo "$(B)/figures/$*.svg .pdf .png"

# Pictures of pages show the piles that the words are of: tables in results come before those just made. As SVG, and as PNG
# with the first dots an inch and colours that take at most 80 kB.
draw_shown = gnuplot -e "T='$(B)/best/$*/'; tables='$(call tables_of,$*)'; terminal='$(1)'; shown=$${try% *}.; file='$(@:.png=)'" \
	    figures/style.gp $(wildcard figures/*/$*.gp)
$(B)/figures/shown/%.png: $(B)/figures/%.svg $$(wildcard $$(addprefix results/,$$(call tables_of,$$*)))
	@set -e; mkdir -p $(@D) $(B)/best/$*; for t in $(sort $(foreach t,$(call tables_of,$*),$(firstword $(subst /, ,$(t))))); do \
	  [ -e results/$$t ] && cp results/$$t $(B)/best/$* || cp -r $(T)/$$t $(B)/best/$*; done
	@set -e; for try in '220 64' '220 16' '180 16'; do $(call draw_shown,shown); \
	  pngquant --force --nofs --output $@ $${try#* } $@; [ $$(stat -c %s $@) -gt 80000 ] || break; done; $(call draw_shown,svg)

make_html = sh report/page/page.sh $(REPOSE) $(B)
report: figures validate $(SHOWN:%=$(B)/figures/shown/%.png) ## paper-repro.md, docs and the pictures that they and README show; build/report.html, by pandoc
	@$(keep_tables); $(sign_results)
	@tables=results,results/kept; $(make_pages); for p in $(PAGES); do cp $(B)/$$p.md $$p.md; done
	@cp $(SHOWN:%=$(B)/figures/shown/%.png) figures/shown
	@$(make_html)
	@[ ! -e .git ] || git --no-pager diff --exit-code --stat HEAD -- $(PAGES:=.md) results || \
	  { echo "report: these differ from the last commit; look at them (git diff), and commit them" >&2; exit 1; }
check-report: figures ## build/report.html in headless Chromium: pictures, controls, console, widths; installs pandoc and Chromium
	@$(make_html) && sh report/page/check.sh $(B)

include tests/longer.mk install.mk
.PRECIOUS: $(T)/%.tsv $(B)/made/% $(B)/studied/% $(B)/validated/%
clean: ## remove everything made
	rm -rf $(B)
