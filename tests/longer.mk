# What takes long, or needs programs that `make setup` does not install.
.PHONY: fuzz analyze analyze-readers drill changes mutate check-readers check-arm64 check-report studies
fuzz: ## fuzz every reader with libFuzzer and clang: make fuzz FOR=60 (seconds each), FOR=runs=100000, TARGETS='scene line'
	@sh tests/fuzz/fuzz.sh $(B) $(or $(FOR),60) $(JOBS) $(TARGETS)
analyze: $(REPOSE) ## compare gcc -fanalyzer, cppcheck, clang-tidy, scan-build and valgrind with the list in tests/analyze.txt
	@sh tests/analyze.sh $(B) $(JOBS)
analyze-readers:
	@sh tests/analyze.sh $(B) $(JOBS) readers
drill: $(B)/check $(REPOSE) $(REPORT) ## fault-injection tests of sweeps, with 2000 kills (KILLS=); the matrix of determinism; `make changes`
	@RP_DRILL=$(or $(KILLS),2000) REPOSE=$(REPOSE) $(B)/check drill && sh tests/drill/matrix.sh $(B) && sh tests/changes/changes.sh $(B)
changes: $(B)/check $(REPOSE) $(REPORT) ## check that small changes of each kind pass, and that none of their files can be forgotten; CHANGES='column command'
	@sh tests/changes/changes.sh $(B) $(CHANGES)
mutate: | $(SETUP_FIRST) ## mutation test: change the program line by line, and count what the tests detect; MUTANTS=300, SEED=0 draws them
	@sh tests/mutate/mutate.sh $(B) $(or $(MUTANTS),300) $(JOBS) $(or $(SEED),0)
check-readers: $(REPOSE) $(B)/check setup-peers ## read exports with LAMMPS, VTK and pandas; as root, installs them
	@REPOSE=$(REPOSE) $(B)/check export
check-arm64: $(REPOSE) ## tests of bitwise identity on 64-bit Arm, with qemu in its own Debian root; needs root, mmdebstrap and 1 GB
	@sh tests/arm64.sh
check-report: figures ## test build/report.html in headless Chromium: pictures, controls, console, widths; installs pandoc and Chromium
	@$(make_html) && sh report/page/check.sh $(B)
studies: $(STUDIES:%=$(B)/studied/%) ## run larger ensembles for days, with tables in results; can be stopped and continued
$(B)/studied/%: %.cfg $(CODE)
	@echo "sweep   $* --study" && $(REPOSE) sweep make $< -o $(B)/sweeps/$* --tables $(B)/studies/$* -j $(JOBS) --study
	@mkdir -p $(@D) results/$* && cp $$(ls $(B)/studies/$*/*.tsv | grep -v '/runs.tsv$$\|/row_[0-9]*.tsv$$') results/$* && sh report/keep.sh && touch $@
$(B)/studied/lh_size_large $(B)/studied/lh2b_wide $(B)/studied/lh_rough_large: $(addprefix $(B)/studied/,lh_size lh_size_mid lh2b_narrow lh_rough)
# Speed, against LAMMPS and LIGGGHTS where installed; for a quiet machine, two hours. Starts are kept.
BENCH_peers        = peers.sh $(REPOSE) $(B)/bench 5
BENCH_instructions = instructions.sh $(REPOSE) $(B)/bench
BENCH_scaling      = scaling.sh $(REPOSE) $(B)/bench scaling '1000 10000 100000 1000000'
BENCH_workers      = scaling.sh $(REPOSE) $(B)/bench workers 5
$(T)/bench/%.tsv: $(CODE) $(wildcard validation/peers/*)
	@mkdir -p $(@D) && echo "bench   $*" && bash validation/peers/$(BENCH_$*) >$@
$(T)/bench/done: $(T)/bench/peers.tsv
	@touch $@
bench: $(B)/figures/bench.svg ## compare speed with LAMMPS and LIGGGHTS; instructions, scaling, two workers; tables and a figure
	@$(MAKE) --no-print-directory -j1 $(addprefix $(T)/bench/,instructions.tsv scaling.tsv workers.tsv)
