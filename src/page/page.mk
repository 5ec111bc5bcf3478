# A pile in the browser: one file of HTML that holds the simulator as WebAssembly, by clang. GSL and libconfig come as
# Debian's sources. Nothing else needs any of this.
PAGE     := $(B)/page
PAGE_CC  := clang --target=wasm32-wasi --sysroot=/usr -ffp-contract=off -D_GNU_SOURCE -I$(PAGE)/include
PAGE_C   := -std=c11 -O3 -fno-math-errno -Wall -Wextra -Wno-missing-field-initializers -DXXH_INLINE_ALL= -Isrc/page/posix -Isrc -I. \
            -D_WASI_EMULATED_PROCESS_CLOCKS -Dru_maxrss=ru_utime.tv_sec -DMADV_HUGEPAGE=0 '-Dgetrandom(to,n,how)=-1' $(WERROR)
PAGE_GSL := err/error err/stream err/strerror randist/tdist rng/inline rng/mt rng/rng \
            roots/brent roots/convergence roots/fsolver sort/sortvec sys/infnan sys/pow_int \
            $(addprefix cdf/,chisq gamma gauss gaussinv tdist tdistinv) \
            $(addprefix specfunc/,beta erfc exp gamma gamma_inc log psi zeta) \
            $(addprefix statistics/,mean minmax variance)
PAGE_OWN := $(filter-out src/core/folder.c,$(wildcard $(foreach m,core stats analytic dem angle stress exp,$(patsubst %,%/*.c,$(call rooms,$(m))))))
PAGE_OBJ := $(PAGE_OWN:%.c=$(PAGE)/obj/%.o) $(PAGE_GSL:%=$(PAGE)/obj/gsl/%.o) \
            $(patsubst %,$(PAGE)/obj/libconfig/lib/%.o,libconfig grammar scanner scanctx strbuf)
PAGE_TEXTS := $(patsubst %,examples/%.cfg,box cylinder hopper drum)
.PHONY: setup-page page check-page
setup-page: ## install what `make page` needs: clang for WebAssembly, sources of GSL and libconfig
	@sh tests/setup.sh clang lld llvm wasi-libc libclang-rt-14-dev-wasm32 librandom123-dev libxxhash-dev libsqlite3-dev libsuitesparse-dev
	@sh src/page/sources.sh $(PAGE)
page: $(PAGE)/index.html ## build build/page/index.html: a pile in the browser, in one file
	@echo "page    $<, $$(stat -c %s $<) bytes"
check-page: page $(REPOSE) ## test that page in headless Chromium: every control, digests of `repose run`, widths, pictures
	@sh tests/page/check.sh $(REPOSE) $(PAGE)
$(PAGE)/obj/libconfig/%.o: PAGE_C := -O2 -w
$(PAGE)/obj/gsl/%.o: PAGE_C := -O2 -w -DHAVE_CONFIG_H -I$(PAGE)/gsl
$(PAGE)/obj/src/core/random.o: PAGE_C += -D__arm__ # of the machines that Random123 knows, the one with 32 bits and no more
$(PAGE)/obj/src/dem/loops/width_1.o: PAGE_C += -msimd128 # grains that roll go a quarter faster
$(PAGE)/obj/%.o: %.c src/page/page.mk
	@mkdir -p $(@D) && echo "wasm    $<" && $(PAGE_CC) $(PAGE_C) -MMD -MP -c $< -o $@
$(PAGE)/obj/gsl/%.o $(PAGE)/obj/libconfig/%.o: | $(PAGE)/include
	@mkdir -p $(@D) && $(PAGE_CC) $(PAGE_C) -I$(dir $(PAGE)/$(@:$(PAGE)/obj/%=%)) -c $(@:$(PAGE)/obj/%.o=$(PAGE)/%.c) -o $@
$(PAGE)/include: | $(filter setup-page,$(MAKECMDGOALS))
	@[ -d $@ ] || { echo "page: first run: make setup-page" >&2; exit 1; }
-include $(patsubst %.o,%.d,$(PAGE_OWN:%.c=$(PAGE)/obj/%.o) $(PAGE)/obj/src/page/page.o)
$(PAGE_OWN:%.c=$(PAGE)/obj/%.o) $(PAGE)/obj/src/page/page.o: | $(PAGE)/include
$(PAGE)/engine.wasm: $(PAGE)/obj/src/page/page.o $(PAGE_OBJ) src/page/absent.txt
	@rm -f $(PAGE)/engine.a && llvm-ar qcs $(PAGE)/engine.a $(PAGE_OBJ)
	@$(PAGE_CC) -mexec-model=reactor $< $(PAGE)/engine.a -lm -Wl,--allow-undefined-file=src/page/absent.txt -Wl,--gc-sections -Wl,--strip-all -o $@
$(PAGE)/index.html: $(PAGE)/engine.wasm src/page/page.html src/page/page.js src/page/join.sh $(PAGE_TEXTS)
	@sh src/page/join.sh $< src/page $(PAGE_TEXTS) >$@
