# Repose. `make help` lists the targets.
.DEFAULT_GOAL := all
.DELETE_ON_ERROR:
.SUFFIXES:

B       := build
T       := $(B)/tables
vpath %.cfg sweeps/lh sweeps/li sweeps/val sweeps/studies
vpath %.gp figures/lh figures/li figures/val
JOBS    ?= $(shell nproc)
WORKERS := $(JOBS)
CC      := gcc
WERROR  :=
SAN     :=
CFLAGS  := -std=c11 -O3 -ffp-contract=off -fno-math-errno -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes \
           -Wmissing-prototypes -Wconversion -Werror=switch-enum -Wno-sign-conversion \
           -Wno-missing-field-initializers $(WERROR) $(SAN)
CPPFLAGS := -D_GNU_SOURCE -Isrc -I.

# Debian packages that the project needs, for `setup`.
PACKAGES := pkg-config libgsl-dev libnlopt-dev libcunit1-dev gnuplot-nox libconfig-dev libsqlite3-dev \
            librandom123-dev libsuitesparse-dev libxxhash-dev fonts-dejavu-core clang-format
# pkg-config runs inside the recipes, so that `make setup figures` works in one call.
PC       := pkg-config
PKGS     := gsl nlopt libconfig sqlite3 libxxhash
LIBS      = $$($(PC) --libs $(PKGS)) -lcholmod -lm
INCLUDES  = $$($(PC) --cflags $(PKGS))

# Whatever compiles waits for `setup` when both are asked for.
SETUP_FIRST := $(filter setup,$(MAKECMDGOALS))

MODULES := core stats analytic dem statics angle stress sweep
DIR_core := src/core
DIR_analytic := analytic
DIR_dem := src/dem
DIR_angle := src/angle
DIR_statics := src/statics
DIR_stats := src/stats
DIR_stress := src/stress
DIR_sweep := sweeps/driver
PREFIX_core := rp_
PREFIX_analytic := an_
PREFIX_dem := dem_
PREFIX_angle := ang_
PREFIX_statics := statics_
PREFIX_stats := stats_
PREFIX_stress := stress_
PREFIX_sweep := sweep_

objects  = $(patsubst %.c,$(B)/obj/%.o,$(wildcard $(1)/*.c))
ARCHIVES := $(MODULES:%=$(B)/lib%.a)
# dependents before what they depend on
LINKED   := $(B)/libsweep.a $(B)/libanalytic.a $(B)/libdem.a $(B)/libstatics.a $(B)/libangle.a $(B)/libstress.a $(B)/libstats.a $(B)/libcore.a
CLI      := $(call objects,src/cli)
CHECK    := $(call objects,tests) $(call objects,validation)

.PHONY: all figures studies bench report check test validate mutate asan lint setup help clean FORCE
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
	@echo "compile $<"
	@$(CC) $(CPPFLAGS) $(INCLUDES) $(CFLAGS) -MMD -MP -c $< -o $@

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
	@echo "link    $@"
	@$(CC) $(CFLAGS) $^ $(LIBS) -o $@

$(B)/check: $(CHECK) $(LINKED)
	@echo "link    $@"
	@$(CC) $(CFLAGS) $^ $$($(PC) --libs cunit) $(LIBS) -o $@

-include $(patsubst %.o,%.d,$(CLI) $(CHECK) $(foreach m,$(MODULES),$(call objects,$(DIR_$(m)))))

# figures that take no time, so that the tests see the whole way from a model to a picture
QUICK_FIGURES := li13 li14 li18 li19

lint: $(ARCHIVES) ## the modules' borders (who includes whom, which prefix is exported), and clang-format
	@sh tests/lint.sh $(B) $(foreach m,$(MODULES),$(m)=$(DIR_$(m))=$(PREFIX_$(m)))

# The plain tests come last: CUnit's summary is then what `make check` ends with.
check: lint asan $(B)/check $(B)/repose $(QUICK_FIGURES:%=$(B)/figures/%.svg) ## unit tests and fast validation, with sanitizers and plain
	@echo "check   plain"
	@REPOSE=$(B)/repose $(B)/check -j$(JOBS)

SUITE :=
TEST  :=
test: $(B)/check $(B)/repose ## some tests: make test SUITE=dem TEST='part of a name'
	@REPOSE=$(B)/repose $(B)/check -j$(JOBS) $(SUITE) --test '$(TEST)'

validate: $(B)/check $(B)/repose ## the validation at full size, with its tables in build/tables
	@REPOSE=$(B)/repose $(B)/check --full -o $(T)

# Number of mutants.
MUTANTS := 300
mutate: | $(SETUP_FIRST) ## changes the models line by line: do the tests see it? A table in build/tables
	@sh tests/mutate.sh $(B) $(MUTANTS) $(JOBS)

asan: | $(SETUP_FIRST) ## the same tests under the address and undefined-behaviour sanitizers
	@$(MAKE) --no-print-directory B=$(B)/asan SAN='-fsanitize=address,undefined -fno-sanitize-recover=all -g -O1' \
	  $(B)/asan/check $(B)/asan/repose
	@echo "check   with sanitizers"
	@REPOSE=$(B)/asan/repose RP_CHECK_FAST=1 $(B)/asan/check -j$(JOBS)

# ---- Figures: sweeps and models -> tables -> pictures -------------------------------------------------


REPOSE := $(B)/repose
# A table is stale when any code but the commit's name has changed.
CODE := $(filter-out %/version.o,$(CLI) $(foreach m,$(MODULES),$(call objects,$(DIR_$(m))))) | $(REPOSE)
# of ensembles that only `make studies` makes
STUDY_FIGURES := lh_forensics li_size li20a li20b
# of this machine's times, that only `make bench` measures
BENCH_FIGURES := bench
FIGURES := $(filter-out $(STUDY_FIGURES) $(BENCH_FIGURES),$(basename $(notdir $(wildcard figures/*/*.gp))))
figure_tables = $(addprefix $(T)/,$(shell grep -oE "t\('[^']+[.]tsv'\)" $(wildcard figures/*/$(1).gp) | sed "s/t('//; s/')//" | sort -u))

# Each core works on something of its own, so that none waits for the last run of a sweep; what takes longest comes
# first. What is timed, alone.
figures: | $(SETUP_FIRST) ## every figure, into build/figures, and build/paper-repro.md
	@$(MAKE) -s -j$(JOBS) $(REPOSE) $(B)/check
	@$(MAKE) -s -Oline -j$(JOBS) WORKERS=1 $(filter %_precision,$(VALIDATED)) $(SWEPT:%=$(T)/%.tsv) $(T)/lh_stress_piles \
	  $(VALIDATED) $(FIGURES:%=$(B)/figures/%.svg) $(patsubst %,$(T)/%.tsv,$(filter-out bench run_times,$(REPORT_TABLES)))
	@$(MAKE) -s $(B)/paper-repro.md
fig-%: $(B)/figures/%.svg
	@echo "$(B)/figures/$*.svg .pdf .png"

define figure_rule
$(B)/figures/$(1).svg: $(1).gp figures/style.gp $(call figure_tables,$(1)) | $(SETUP_FIRST)
	@mkdir -p $$(@D)
	@for t in pdf png svg; do gnuplot -e "T='$(T)/'; terminal='$$$$t'; file='$(B)/figures/$(1)'" \
	  figures/style.gp $$< || exit 1; done
	@echo "figure  $(1)"
endef
$(foreach f,$(FIGURES) $(STUDY_FIGURES) $(BENCH_FIGURES),$(eval $(call figure_rule,$(f))))

# A sweep's tables: one row a grid point, and one row a run. Only runs that are not stored are made. Argument:
# further options of `repose sweep plan`.
define make_sweep
@mkdir -p $(T)
@echo "sweep   $* $(1)"
@$(REPOSE) sweep plan $< -o $(B)/sweeps/$* $(1) >/dev/null
@$(REPOSE) sweep run $(B)/sweeps/$* -j $(WORKERS) >/dev/null
@$(REPOSE) sweep export $(B)/sweeps/$* --reduce >$(T)/$*.tsv
endef
$(T)/%.tsv: %.cfg $(CODE)
	$(call make_sweep)
$(T)/%_runs.tsv: $(T)/%.tsv
	@$(REPOSE) sweep export $(B)/sweeps/$* >$@
$(T)/%_compare.tsv: $(T)/%_runs.tsv
	@$(REPOSE) angle compare $< >$@
$(T)/%_phi.tsv: $(T)/%_runs.tsv
	@$(REPOSE) angle phi $< >$@
$(T)/%_critical.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stress critical $< >$@
# Dropped piles: the dip of the mean pressure on their bases, over a triangle and without one, and that pressure.
$(T)/%_dip.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stress dip $< >$@
$(T)/%_dip_raw.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stress dip $< --against zero >$@
# The same for some of the piles: those of one friction of the base; triangles of the hardest disks, by disorder.
$(T)/li_disorder_mu_%_dip.tsv: $(T)/li_disorder_mu_runs.tsv
	@$(REPOSE) stress dip $< --where mu=$* >$@
$(T)/li_disorder_%_dip.tsv: $(T)/li_disorder_runs.tsv
	@$(REPOSE) stress dip $< --where inner_deg=auto --where 'eps<1e-5' --where disorder=$* >$@
$(T)/li_disorder_mu_trend.tsv: $(T)/li_disorder_mu_runs.tsv
	@$(REPOSE) stats trend $< --x mu --y D --pair --margin 0.1 >$@
$(T)/%_profile.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stress dip $< --profile >$@
$(T)/%_fit_theta_r.tsv: $(T)/%.tsv
	@$(REPOSE) stats fit $< --x mu --y theta_r3_deg_mean --se theta_r3_deg_se --from 0.05 --to 0.2 >$@
$(T)/%_fit_theta_t.tsv: $(T)/%.tsv
	@$(REPOSE) stats fit $< --x mu --y theta_t_displacement_deg_mean --se theta_t_displacement_deg_se --from 0.05 --to 0.2 >$@

# Calibration on planted piles; too few intervals that hold the truth (exit status 1) are a result too.
$(T)/calibrate_verify.tsv: $(T)/calibrate_runs.tsv $(T)/calibrate_planted_runs.tsv
	@$(REPOSE) calibrate --runs $< --planted $(word 2,$^) --verify 100 >$@ || [ $$? = 1 ]

$(T)/%_linear.tsv: $(T)/%.tsv
	@$(REPOSE) stats fit $< --x mu --y theta_r3_deg_mean --se theta_r3_deg_se --successive >$@
$(T)/%_linear_theta_t.tsv: $(T)/%.tsv
	@$(REPOSE) stats fit $< --x mu --y theta_t_displacement_deg_mean --se theta_t_displacement_deg_se --successive >$@
# Trends of theta_R, and of what else is named, over what a sweep varies; margin 1 degree.
TREND_lh2a := --x H --by mu
TREND_lh2b_all := --x W --by mu --power 2
TREND_lh_kn := --x k_n --scale log --pair
TREND_lh_kn_wall := $(TREND_lh_kn)
TREND_lh_kn_restitution := $(TREND_lh_kn)
TREND_lh_gamma_s := --x gamma_s --scale log --pair
TREND_lh_gamma := --x gamma_n --scale log --pair
TREND_lh_ks := --x k_s --scale log --pair
# where the upper part of the range starts, for those with one
UPPER_lh2b_all := 3.5
UPPER_lh_ks := 1e4
TREND_lh_gear := --x integrator --by dt --pair
# with rotation a fill has a pile for each mu_roll: 0 is the one that differs in rotation alone
TREND_lh_rotation := --x rotation --by mu,mu_roll --pair
TREND_lh_wall := --x mu_wall --by W --pair
TREND_lh_grain := --x mu --by W --pair
TREND_val_dt := --x dt --scale log --pair --margin 0.3
TREND_val_integrator := --x integrator --pair --margin 0.3
$(T)/lh2b_all_runs.tsv: $(T)/lh2b_runs.tsv $(T)/lh2b_beyond_runs.tsv
	@cat $^ >$@
$(T)/lh5_trend.tsv: $(T)/lh5_runs.tsv
	@$(REPOSE) stats trend $< --x v_cut --y theta_deg --scale log >$@
$(T)/%_trend.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats trend $< --y theta_r3_deg $(TREND_$*) >$@
$(T)/%_trend_method2.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats trend $< --y theta_r2_deg $(TREND_$*) >$@
$(T)/%_trend_r12.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats trend $< --y theta_r12_deg $(TREND_$*) >$@
$(T)/%_trend_bottom.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats trend $< --y theta_lower_less_upper_deg $(TREND_$*) >$@
# Gravity turned against the box turned, and one rate against another, on the same piles.
$(T)/lh_tilt_trend_%.tsv: $(T)/lh_tilt_runs.tsv
	@$(REPOSE) stats trend $< --y theta_t_$*_deg --x tilt --by mu,tilt_rate_deg --pair >$@
$(T)/lh_tilt_rate_%.tsv: $(T)/lh_tilt_runs.tsv
	@$(REPOSE) stats trend $< --y theta_t_$*_deg --x tilt_rate_deg --scale log --by mu,tilt --pair >$@
$(T)/%_trend_upper.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats trend $< --y theta_r3_deg $(TREND_$*) --from $(UPPER_$*) >$@
# What a standard error of a degree costs.
$(T)/%_degree.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats cost $< --y theta_r3_deg --by W,dt,rest_energy --size W >$@
$(T)/%_size.tsv: $(T)/%_runs.tsv
	@$(REPOSE) stats size $< --x W --y theta_r3_deg --by mu >$@
# Static piles of growing size: the limits of N and H, by straight lines from a base on that is in the name.
$(T)/li_size_all_runs.tsv: $(T)/li_size_runs.tsv $(T)/li_size_large_runs.tsv
	@cat $^ >$@
$(T)/li_size_limit_%.tsv: $(T)/li_size_all_runs.tsv
	@from=$*; $(REPOSE) stats size $< --x base --y $${from#*_} --by well --from $${from%%_*} >$@
# Does a change shrink with the size of the box?
$(T)/%_shrink.tsv: $(T)/%_trend.tsv
	@$(REPOSE) stats fit $< --x W --y change --se change_se >$@

# The published numbers, for figures.
$(T)/published.tsv: figures/claims.tsv $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) claims --published >$@

# Which choices that the paper leaves open agree with its numbers; and a second look at what is left.
FORENSICS := combinations effects levels
FACTORS_lh_forensics := floor,density,mu_wall,mu_floor,slip,shape,tension,damping,integrator,dt:density,relax_steps:dt,fill,k_n_wall,open,g
FACTORS_lh_forensics_confirm := slip,mu_wall,open
define forensics_rule
$(FORENSICS:%=$(T)/$(1)_%.tsv): $(T)/$(1)_%.tsv: $(T)/$(1)_runs.tsv figures/claims.tsv
	@$(REPOSE) forensics $$< --factors $(FACTORS_$(1)) --draws 4000 --report $$* >$$@
endef
$(foreach s,lh_forensics lh_forensics_confirm,$(eval $(call forensics_rule,$(s))))

# Larger ensembles of the sweeps behind figures and report, in the same tables: `make studies`, then `make figures`.
# A study that was stopped goes on; the runs of `make figures` are the first of its own.
STUDY_lh3 := 20
STUDY_lh3_total := 20
STUDY_lh5 := 10
STUDY_lh_floor := 40
STUDY_lh2a := 60
STUDY_lh2b := 60
STUDY_lh2b_beyond := 10
STUDY_lh_kn := 40
STUDY_lh_kn_wall := 40
STUDY_lh_kn_restitution := 40
STUDY_lh_gamma := 40
STUDY_lh_ks := 40
STUDY_lh_wall := 20
STUDY_lh_grain := 20
STUDY_lh_smooth0 := 40
STUDY_lh_gear := 60
STUDY_lh_tilt := 20
STUDY_lh_tilt_static := 12
STUDY_lh_rotation := 10
STUDY_li20_point := 200
STUDY_li20_broad := 100
STUDY_li20_sizes := 100
STUDY_li20_hard := 100
STUDY_li20_rest := 100
STUDY_li20_choices := 40
STUDY_li_size_large := 1
STUDY_li_disorder := 200
STUDY_li_disorder_mu := 200
STUDY_li_slopes_disorder := 16
# In boxes of W = H = 3 cm, at rest at 1e-5 m g d and 0.1 m g, two piles of one fill differ by some 5 degrees: 95 %
# intervals of +-0.12 and +-0.18 degrees take so many, to tell 0.3 from none.
STUDY_val_dt := 7000
STUDY_val_integrator := 3000
STUDY_val_cost := 20
STUDY_calibrate := 12
$(B)/studies/%: %.cfg $(CODE)
	$(call make_sweep,--replicas $(STUDY_$*))
	@mkdir -p $(@D)
	@touch $@
STUDIES := $(patsubst STUDY_%,$(B)/studies/%,$(filter STUDY_lh% STUDY_li% STUDY_val% STUDY_calibrate,$(.VARIABLES)))
studies: $(STUDIES) $(STUDY_FIGURES:%=$(B)/figures/%.svg) $(FORENSICS:%=$(T)/lh_forensics_confirm_%.tsv) $(T)/calibrate_verify.tsv ## larger ensembles for the figures; resumable

# One row of a sweep with its grains, contacts and energies.
$(T)/%/filled_grains.tsv $(T)/%/filled_contacts.tsv $(T)/%/pile_grains.tsv $(T)/%/pile_contacts.tsv \
$(T)/%/energy.tsv $(T)/%_row.tsv: %.cfg $(CODE)
	@mkdir -p $(T)
	@echo "run     $*"
	@$(REPOSE) run $< --row 0 -o $(T)/$* >$(T)/$*_row.tsv

# One row of the sweep of constant flux, as a series in time.
$(T)/lh5_row%/series.tsv $(T)/lh5_row%.tsv: sweeps/lh/lh5.cfg $(CODE)
	@mkdir -p $(T)
	@echo "run     lh5, row $*"
	@$(REPOSE) run $< --row $* -o $(T)/lh5_row$* >$(T)/lh5_row$*.tsv
# The largest of ten opened boxes whose floor ends: what the maximum of ten angles under flux compares with.
$(T)/lh_floor_maximum.tsv: $(T)/lh_floor_runs.tsv
	@$(REPOSE) stats maximum $< --where floor=ends --column theta_r3_deg --draws 10 >$@

# The stress of 20 piles of mu = 0.2, from their contacts at rest: the field, and the forces on the base.
STRESS_ROWS := $(shell seq 20 39)
$(T)/lh_stress_piles: sweeps/studies/lh_stress.cfg $(CODE)
	@echo "run     lh_stress"
	@printf "%s\n" $(STRESS_ROWS) | xargs -P $(WORKERS) -I R $(REPOSE) run $< --row R --every 100000 -o $@/R >/dev/null
	@touch $@
$(T)/lh_stress_field.tsv: $(T)/lh_stress_piles
	@$(REPOSE) stress field $(STRESS_ROWS:%=$</%/tilt_0) --width 4 --cell 0.4 >$@
$(T)/lh_stress_base.tsv: $(T)/lh_stress_piles
	@$(REPOSE) stress base $(STRESS_ROWS:%=$</%/tilt_0) --width 4 --cell 0.4 >$@

# Models on paper: the angle, or the tent's outer and inner angle and 100 x_1/B, is in the name.
$(T)/continuum_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) continuum --alpha-deg $* >$@
$(T)/lattice_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) lattice --base 45 --alpha-deg $* >$@
tent_words = $(subst _, ,$(1))
$(T)/tent_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) tent --outer-deg $(word 1,$(call tent_words,$*)) --inner-deg $(word 2,$(call tent_words,$*)) \
	  --x1 0.$(word 3,$(call tent_words,$*)) --points 401 >$@
$(T)/tent_map_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) tent --map --x1 0.$* >$@
$(T)/triangle_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) lattice --layers $* >$@
# Soft disks: base, angle and eps, or 0 for the limit, are in the name; in a folder of that name the contacts and disks.
pile_words = $(subst _, ,$(1))
define make_pile
@mkdir -p $(T)
@$(REPOSE) pile --base $(word 1,$(call pile_words,$*)) --alpha-deg $(word 2,$(call pile_words,$*)) \
  --eps $(word 3,$(call pile_words,$*)) $(1)
endef
$(T)/pile_%.tsv $(T)/pile_%/contacts.tsv $(T)/pile_%/disks.tsv: $(CODE)
	$(call make_pile,-o $(T)/pile_$* >$(T)/pile_$*.tsv)
$(T)/pile_minimum_%.tsv: $(CODE)
	$(call make_pile,--branch minimum $(addprefix --leave ,$(word 4,$(call pile_words,$*))) >$@)
# base, tent and eps, and the half-width of the wells where they are not springs
pile_tent = --base $(word 1,$(1)) --alpha-deg $(word 2,$(1)) --inner-deg $(word 3,$(1)) --x-1 0.$(word 4,$(1))
$(T)/pile_tent_%.tsv: $(CODE)
	@mkdir -p $(T)
	@$(REPOSE) pile $(call pile_tent,$(call pile_words,$*)) --eps $(word 5,$(call pile_words,$*)) \
	  $(addprefix --well ,$(word 6,$(call pile_words,$*))) >$@
# One row a pile: the first with its header.
define one_table
@$(REPOSE) stats select $@.rows >$@
@rm $@.rows
endef
$(T)/pile_eps.tsv: $(CODE)
	@mkdir -p $(T)
	@for e in 1e-3 3e-4 1e-4 3e-5 1e-5 1e-6 1e-7 1e-8; do \
	  $(REPOSE) pile --eps $$e --summary || exit 1; done >$@.rows
	$(one_table)
$(T)/pile_eps_slope.tsv: $(T)/pile_eps.tsv
	@$(REPOSE) stats fit $< --x eps --y N_error_rms --scale log --where negative_modes=0 >$@
$(T)/pile_minima.tsv: $(CODE)
	@mkdir -p $(T)
	@for k in $$(seq 16); do \
	  $(REPOSE) pile --branch minimum --leave $$k --summary || exit 1; done >$@.rows
	$(one_table)
$(T)/pile_threshold.tsv: $(CODE)
	@mkdir -p $(T)
	@for k in 6 8 12 16 24 32 45 64 90; do \
	  $(REPOSE) pile --base $$k --threshold || exit 1; done >$@.rows
	$(one_table)
# What the base must bear, by slope: on springs, and on wells of friction that hold.
SLOPES := 30 32.6 45 50 55 60
$(T)/pile_friction.tsv: $(CODE)
	@mkdir -p $(T)
	@for a in $(SLOPES); do for w in "--k-x 1" "--well 1 --mu 1"; do \
	  $(REPOSE) pile --alpha-deg $$a $$w --summary || exit 1; done; done >$@.rows
	$(one_table)
# Where x_0 is, and whether wells are set again: which piles stand (exit status 1: it spreads), and the forces of two that do.
$(T)/pile_again.tsv: $(CODE)
	@mkdir -p $(T)
	@echo "pile    wells set again"
	@for a in 30 45 60; do for set in "" "--set-load 1" "--set-again" "--set-load 1 --set-again"; do for mu in $$(seq 0.15 0.01 0.6); do \
	  $(REPOSE) pile --alpha-deg $$a --well 1 --mu $$mu $$set --summary 2>/dev/null || [ $$? = 1 ] || exit 1; done; done; done >$@.rows
	$(one_table)
$(T)/pile_again_threshold.tsv: $(T)/pile_again.tsv
	@$(REPOSE) stats threshold $< --x mu --by alpha_deg,set_load,set_again --most broken >$@
$(T)/li_smooth_threshold.tsv: $(T)/li_smooth_runs.tsv
	@$(REPOSE) stats threshold $< --x mu --by alpha_deg,well --most broken >$@
$(T)/pile_x0.tsv: $(CODE)
	@mkdir -p $(T)
	@for s in "--alpha-deg 30 --well 1" "--alpha-deg 30 --well 100" "--alpha-deg 30 --well 200" "--alpha-deg 60 --well 1" \
	  "--alpha-deg 30 --inner-deg 45 --x-1 0.38 --well 1" "--alpha-deg 30 --inner-deg 45 --x-1 0.38 --well 100"; do for load in 0 0.5 1; do \
	  $(REPOSE) pile $$s --set-load $$load --summary || exit 1; done; done >$@.rows
	$(one_table)
# Validation: validation_SUITE.tsv and validation_SUITE_*.tsv come from one run of the suite of that name.
.SECONDEXPANSION:
$(T)/validation_%.tsv: $(T)/.validation_$$(firstword $$(subst _, ,$$*)) ;
$(T)/.validation_%: $(call objects,validation) $(CODE) $(B)/check
	@mkdir -p $(T)
	@echo "check   --full $*"
	@REPOSE=$(B)/repose $(B)/check --full -o $(T) $* >$(B)/validation_$*.log || { cat $(B)/validation_$*.log; exit 1; }
	@touch $@
# last and alone: nothing else may run while it is timed
$(T)/bench.tsv: $(CODE) $(FIGURES:%=$(B)/figures/%.svg) $(T)/lh_floor.tsv
	@mkdir -p $(T)
	@echo "bench   1372 grains"
	@$(REPOSE) bench --n 1372 >$@

# Speed, against LAMMPS and LIGGGHTS where they are installed, and what it depends on; for a quiet machine, an hour. Starts are kept.
BENCH_SETTLED := 400 1600 10000 100000
BENCH_FLOWING := 400 1600 10000
BENCH_PAIRS := 5
BENCH_GROWTH := 1000 10000 100000 1000000
$(T)/bench_%.tsv: $(CODE) $(wildcard validation/peers/*)
	@mkdir -p $(T)
	@echo "bench   $*"
	@bash validation/peers/$(BENCH_$*) >$@
BENCH_peers = peers.sh $(REPOSE) $(B)/bench '$(BENCH_SETTLED)' '$(BENCH_FLOWING)' $(BENCH_PAIRS)
BENCH_instructions = instructions.sh $(REPOSE) $(B)/bench
BENCH_growth = growth.sh $(REPOSE) $(B)/bench growth '$(BENCH_GROWTH)'
BENCH_workers = growth.sh $(REPOSE) $(B)/bench workers $(BENCH_PAIRS)
bench: $(B)/figures/bench.svg ## speed against LAMMPS and LIGGGHTS, instructions, growth, two workers; tables and a figure, one at a time
	@$(MAKE) --no-print-directory -j1 $(T)/bench_instructions.tsv $(T)/bench_growth.tsv $(T)/bench_workers.tsv

# The report. `make report` puts it, and the few pictures that it and README show, into the repository.
REPORT := figures/paper-repro.md.in
SHOWN := lh1a lh1c lh3 lh7b li13 val_precision_impact
# what only `make studies` and `make mutate` make is taken as it is there
# named by the texts and by the claims, but for those that nothing makes yet: their claims have no data
UNANSWERED := lh_equal_radii lh_wall_trend_top li20_single li20_lines li20_collisions_dip
REPORT_TABLES := $(filter-out lh_forensics% li20% calibrate_planted% calibrate_verify li_size_large li_size_limit% mutate% $(UNANSWERED),$(shell \
  { grep -ohE '\{\{(value|cell|note|rows) [A-Za-z0-9_.-]+' figures/report/*.md | sed 's/.* //'; \
    awk -F'\t' '!/^\#/ && $$6 !~ /constant|formula|picture|untestable/ { split($$11, a, " "); split($$12, b, " "); print a[1]; if (b[2]) print b[1] }' \
      figures/claims.tsv; } | sort -u))
# Where the time goes: processor time of each sweep and validation suite whose table is there.
$(T)/run_times.tsv: $(patsubst %,$(T)/%.tsv,$(filter-out run_times bench,$(REPORT_TABLES)))
	@for s in $(basename $(notdir $(wildcard sweeps/*/*.cfg))); do \
	  sed -n "s/^# run_time: \([0-9.]*\) s/$$s\tsweep\t\1/p" $(T)/$$s.tsv 2>/dev/null; done >$@.rows
	@for s in $(patsubst $(B)/validation_%.log,%,$(wildcard $(B)/validation_*.log)); do \
	  sed -n "s/^Elapsed time = *\([0-9.]*\) seconds/$$s\tvalidation\t\1/p" $(B)/validation_$$s.log; done >>$@.rows
	@sort -t'	' -k3 -gr $@.rows >$@.sorted
	@{ echo "# most: $$(head -8 $@.sorted | awk -F'\t' '{ printf "%s%s %.0f s", (NR > 1 ? ", " : ""), $$1, $$3 }')"; \
	  for k in sweep validation; do awk -F'\t' -v k=$$k '$$2 == k { s += $$3 } END { printf "# %s: %.0f s\n", k, s }' $@.sorted; done; \
	  printf '# units: 1\t1\ts\n# name\tkind\tseconds\n'; cat $@.sorted; } >$@
	@rm $@.rows $@.sorted
SHOWN_TABLES := $(REPORT_TABLES) $(notdir $(basename $(foreach f,$(FIGURES),$(call figure_tables,$(f)))))
VALIDATED := $(addprefix $(T)/.,$(sort $(foreach t,$(filter validation_%,$(SHOWN_TABLES)),validation_$(word 2,$(subst _, ,$(t))))))
# all runs of these sweeps; of lh1 one row is enough
SWEPT := $(foreach s,$(filter-out lh1,$(basename $(notdir $(wildcard sweeps/*/*.cfg)))),$(if $(filter $(s) $(s)_%,$(SHOWN_TABLES)),$(s)))
$(B)/paper-repro.md: $(REPORT) figures/claims.tsv $(wildcard figures/report/*.md) $(REPORT_TABLES:%=$(T)/%.tsv) $(FIGURES:%=$(B)/figures/%.svg)
	@$(REPOSE) report $< --tables $(T) -o $@
	@echo "report  $@"
report: $(B)/paper-repro.md ## paper-repro.md and the pictures in the repository, from the tables
	@mkdir -p figures/shown
	@cp $(SHOWN:%=$(B)/figures/%.png) figures/shown
	@cp $< paper-repro.md
.PRECIOUS: $(T)/%.tsv $(T)/%_runs.tsv $(T)/%_trend.tsv $(T)/.validation_%

clean: ## remove everything made
	rm -rf $(B)
