# Installation, the archive of the source, and the Debian package; see docs/install.md.
PREFIX  ?= /usr/local
TARGET   = $(or $(DESTDIR)$(PREFIX),/)
VERSION := $(shell sed -n 's/^.define RP_VERSION "\(.*\)"/\1/p' src/core/version.h)
.PHONY: install uninstall manual dist deb check-deb
install: $(REPOSE) $(LIBRARY) ## install program, library, headers, sweeps, completion: make install PREFIX=/usr/local DESTDIR=
	@sh install.sh $(B) "$(TARGET)" $(VERSION) $(foreach m,$(filter-out view=% export=%,$(MODULES)),$(call module,$(m)))
	@echo "install $(TARGET)"
uninstall: ## remove what `make install` put into PREFIX
	@sh install.sh --remove "$(TARGET)"
manual: $(REPOSE) | $(SETUP_FIRST) ## make the manual page build/repose.1 from the program's help; needs pandoc
	@command -v pandoc >/dev/null || { echo "manual: pandoc is missing: \`make setup manual\` installs it" >&2; exit 1; }
	@$(REPOSE) help --markdown | pandoc -s -f markdown-smart -t man -o $(B)/repose.1
# Of the last commit, whose name the archive carries in .commit.
DIST := $(B)/repose-$(VERSION).tar.gz
dist: ## pack the last commit as build/repose-VERSION.tar.gz, which builds without git
	@mkdir -p $(B) && git archive --prefix=repose-$(VERSION)/ -o $(DIST) HEAD && echo "dist    $(DIST)"
deb: dist | $(SETUP_FIRST) ## build the Debian package from that archive, into build; needs build-essential, debhelper and pandoc
	@command -v dpkg-buildpackage >/dev/null || { echo "deb: build-essential is missing: \`make setup deb\` installs it" >&2; exit 1; }
	@rm -rf $(B)/deb $(B)/repose*.deb && mkdir -p $(B)/deb && tar -xzf $(DIST) -C $(B)/deb
	@cd $(B)/deb/repose-$(VERSION) && dpkg-buildpackage -us -uc -b
	@mv $(B)/deb/*.deb $(B) && ls $(B)/*.deb
check-deb: deb $(B)/check $(REPOSE) ## run lintian on that package, and the suite `install` on its contents, unpacked without root
	@lintian --allow-root --fail-on error $(B)/repose_*.deb
	@rm -rf $(B)/deb/root && dpkg-deb -x $(B)/repose_*.deb $(B)/deb/root
	@RP_INSTALLED=$(abspath $(B))/deb/root/usr REPOSE=$(REPOSE) $(B)/check install
