# SPDX-License-Identifier: MIT
# ssfr: `make demo` renders and measures a frame, `make check` runs every test, `make help` lists the rest.
# Sources are found by wildcard: a new pass, reader, metric or test is a new file and nothing here.

VERSION := $(shell sed -n 's/^.define SSFR_VERSION "\(.*\)"/\1/p' libssfr/ssfr.h)
SOVERSION := $(firstword $(subst ., ,$(VERSION)))
PREFIX ?= /usr/local
BUILD := build$(if $(SAN),/san)

# Debian and Ubuntu package names; docs/dependencies.md says why each is here.
PACKAGES := gcc g++ libc6-dev make pkg-config libepoxy-dev libegl-dev libegl-mesa0 libgl1-mesa-dri libopenexr-dev \
            libpng-dev zlib1g-dev libhdf5-dev libexpat1-dev libyaml-dev libgsl-dev libopencv-dev \
            libopencv-contrib-dev libcmocka-dev gnuplot-nox

comma := ,
OPT := $(if $(SAN),-O1 -fsanitize=address$(comma)undefined -fno-sanitize-recover=all -fno-omit-frame-pointer,-O2)
FLAGS := $(OPT) -g -Wall -Wextra -Wconversion -Werror -fopenmp -fPIC -MMD -MP -Ilibssfr -I.
CFLAGS_ALL = -std=c17 -D_XOPEN_SOURCE=700 $(FLAGS) -fvisibility=hidden $(CFLAGS)
CXXFLAGS_ALL = -std=c++17 $(FLAGS) -isystem /usr/include/opencv4 $(CXXFLAGS)

PKG = $(shell pkg-config $(1) 2>/dev/null)
LIB_PKGS := epoxy libpng zlib hdf5 expat
LIB_CFLAGS := $(call PKG,--cflags $(LIB_PKGS)) $(patsubst -I%,-isystem %,$(call PKG,--cflags-only-I OpenEXR))
LIB_LIBS := $(call PKG,--libs $(LIB_PKGS)) -lEGL -lOpenEXRCore -lm
METRICS_LIBS := -lopencv_quality -lopencv_imgproc -lopencv_core -lstdc++
APP_CFLAGS := $(call PKG,--cflags yaml-0.1 gsl)
APP_LIBS := $(call PKG,--libs yaml-0.1 gsl)

LIB_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(wildcard libssfr/*/*.c)) $(BUILD)/shaders.o
METRICS_OBJ := $(patsubst %,$(BUILD)/%.o,$(basename $(wildcard metrics/*.c metrics/*.cpp)))
APP_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(filter-out experiments/main.c,$(wildcard experiments/*.c experiments/*/*.c)))
TEST_SRC := $(wildcard tests/test_*.c)
TESTS := $(TEST_SRC:tests/%.c=$(BUILD)/tests/%)
TEST_UTIL_OBJ := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(TEST_SRC),$(wildcard tests/*.c)))

STATIC := $(BUILD)/libssfr.a
SHARED := $(BUILD)/libssfr.so.$(VERSION)
METRICS := $(BUILD)/libmetrics.a
APP := $(BUILD)/libexperiments.a
SSFR := $(BUILD)/ssfr
COMMIT := $(shell git describe --always --dirty --abbrev=40 2>/dev/null)
# `make V=1` shows the commands. A make without -j uses all cores where it calls itself.
Q := $(if $(V),,@)
SUBMAKE = $(MAKE) --no-print-directory $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$$(nproc))

.PHONY: all deps demo check test install uninstall clean help FORCE
.DELETE_ON_ERROR:
.SECONDARY:

all: $(SSFR) $(SHARED)

help:
	@echo 'make all      build/ssfr and the library        make deps     install missing Debian packages'
	@echo 'make demo     render and measure one frame       make check    build and run all tests'
	@echo 'make install  to PREFIX=$(PREFIX)               make clean    remove build/'
	@echo 'SAN=1 builds under ASan and UBSan in build/san; GL=required makes tests that lack GL fail;'
	@echo 'V=1 shows the commands.'

deps:
	@./docs/deps.sh $(PACKAGES)

# ---- the library -------------------------------------------------------------------------------------------------

$(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	@echo "CC   $<"
	$(Q)$(CC) $(CFLAGS_ALL) $(LIB_CFLAGS) $(if $(filter libssfr/%,$<),,$(APP_CFLAGS)) -c $< -o $@

$(BUILD)/%.o: %.cpp
	@mkdir -p $(@D)
	@echo "CXX  $<"
	$(Q)$(CXX) $(CXXFLAGS_ALL) -c $< -o $@

# Every shader as a C string, so that the binary needs no files.
SHADERS := $(sort $(wildcard shaders/*))
$(BUILD)/shaders.c: $(SHADERS) Makefile
	@mkdir -p $(@D)
	@{ echo '#include "gl/shader_source.h"'; echo 'const ssfr_shader_source ssfr_shader_sources[] = {'; \
	  for f in $(SHADERS); do echo "{\"$${f#shaders/}\","; \
	    sed -e 's/\\/\\\\/g' -e 's/"/\\"/g' -e 's/^/"/' -e 's/$$/\\n"/' $$f; echo '},'; done; \
	  echo '{0, 0}};'; } > $@

$(BUILD)/shaders.o: $(BUILD)/shaders.c
	@echo "CC   $<"
	$(Q)$(CC) $(CFLAGS_ALL) -c $< -o $@

$(STATIC): $(LIB_OBJ)
$(METRICS): $(METRICS_OBJ)
$(APP): $(APP_OBJ)
$(STATIC) $(METRICS) $(APP):
	@rm -f $@
	@echo "AR   $@"
	$(Q)$(AR) rcs $@ $^

$(SHARED): $(LIB_OBJ)
	@echo "LD   $@"
	$(Q)$(CC) -shared $(OPT) -fopenmp -Wl,-soname,libssfr.so.$(SOVERSION) -Wl,--no-undefined -o $@ $^ \
	  $(LDFLAGS) $(LIB_LIBS)
	$(Q)ln -sf $(@F) $(BUILD)/libssfr.so.$(SOVERSION)
	$(Q)ln -sf $(@F) $(BUILD)/libssfr.so

# ---- experiments and tests -----------------------------------------------------------------------------------------

# The commit stands in every table's metadata: that one file is made anew when it changes.
$(BUILD)/commit: FORCE
	@mkdir -p $(@D); echo '$(COMMIT)' | cmp -s - $@ || echo '$(COMMIT)' > $@
$(BUILD)/experiments/meta.o: $(BUILD)/commit
$(BUILD)/experiments/meta.o: CFLAGS_ALL += -DSSFR_COMMIT='"$(COMMIT)"'
FORCE:

# The list of files that become part of the binary is made anew when one comes or goes: $(call list_files,FILES,FOLDER).
list_files = @mkdir -p $(@D); n=0; for f in $(1); do \
  echo "X($$n, \"$${f\#$(2)/}\", \"$$f\")"; n=$$((n + 1)); done > $@.new; \
  cmp -s $@.new $@ && rm $@.new || mv $@.new $@

# Every scene file, mesh and particle file becomes part of the binary.
SCENE_FILES := $(sort $(wildcard $(foreach folder,experiments/scenes experiments/scenes/*,\
                 $(foreach ending,yaml obj h5,$(folder)/*.$(ending)))))
$(BUILD)/scene_files.def: FORCE
	$(call list_files,$(SCENE_FILES),experiments/scenes)
$(BUILD)/experiments/scenes/embedded.o: $(BUILD)/scene_files.def $(SCENE_FILES)
$(BUILD)/experiments/scenes/embedded.o: CFLAGS_ALL += -I$(BUILD)
# So does every paper: a folder with claims, its sweeps, and its own numbers in published/.
PAPERS := $(dir $(wildcard experiments/*/claims.yaml))
PAPER_FILES := $(sort $(wildcard $(foreach paper,$(PAPERS),$(paper)*.yaml $(paper)published/*.csv)))
$(BUILD)/paper_files.def: FORCE
	$(call list_files,$(PAPER_FILES),experiments)
$(BUILD)/experiments/papers.o: $(BUILD)/paper_files.def $(PAPER_FILES)
$(BUILD)/experiments/papers.o: CFLAGS_ALL += -I$(BUILD)
$(BUILD)/experiments/bench_integrators_spec.o: experiments/truth/integrators.yaml

$(SSFR): $(BUILD)/experiments/main.o $(APP) $(METRICS) $(STATIC)
	@echo "LD   $@"
	$(Q)$(CC) $(OPT) -fopenmp -o $@ $^ $(LDFLAGS) $(APP_LIBS) $(METRICS_LIBS) $(LIB_LIBS)

$(BUILD)/tests/test_%: $(BUILD)/tests/test_%.o $(TEST_UTIL_OBJ) $(APP) $(METRICS) $(STATIC)
	@echo "LD   $@"
	$(Q)$(CC) $(OPT) -fopenmp -o $@ $^ $(LDFLAGS) $(call PKG,--libs cmocka) $(APP_LIBS) $(METRICS_LIBS) $(LIB_LIBS)

# They count what is allocated, and make it run out of memory.
$(BUILD)/tests/test_allocations $(BUILD)/tests/test_continuum $(BUILD)/tests/test_crossings \
$(BUILD)/tests/test_radiance $(BUILD)/tests/test_truth_memory: \
  private LDFLAGS += -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free

check: deps
	+@$(SUBMAKE) test

# Recursive, because pkg-config's answers change once deps has run.
test: all $(TESTS)
	@BUILD=$(BUILD) GL=$(GL) SAN=$(SAN) ./tests/run.sh $(TESTS)

demo: deps
	+@$(SUBMAKE) all
	@BUILD=$(BUILD) ./experiments/demo.sh

install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/include
	install $(SSFR) $(DESTDIR)$(PREFIX)/bin/ssfr
	install -m 644 libssfr/ssfr.h $(DESTDIR)$(PREFIX)/include/ssfr.h
	install -m 644 $(STATIC) $(DESTDIR)$(PREFIX)/lib/libssfr.a
	install $(SHARED) $(DESTDIR)$(PREFIX)/lib/
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(PREFIX)/lib/libssfr.so.$(SOVERSION)
	ln -sf $(notdir $(SHARED)) $(DESTDIR)$(PREFIX)/lib/libssfr.so
	printf '%s\n' 'prefix=$(PREFIX)' 'Name: ssfr' 'Description: screen-space fluid rendering, with its errors' \
	  'Version: $(VERSION)' 'Requires.private: $(LIB_PKGS)' 'Libs: -L$${prefix}/lib -lssfr' \
	  'Libs.private: -fopenmp -lEGL -lOpenEXRCore -lm' 'Cflags: -I$${prefix}/include' \
	  > $(DESTDIR)$(PREFIX)/lib/pkgconfig/ssfr.pc

uninstall:
	rm -f $(DESTDIR)$(PREFIX)/bin/ssfr $(DESTDIR)$(PREFIX)/include/ssfr.h $(DESTDIR)$(PREFIX)/lib/libssfr.* \
	  $(DESTDIR)$(PREFIX)/lib/pkgconfig/ssfr.pc

clean:
	rm -rf build

-include $(patsubst %.o,%.d,$(LIB_OBJ) $(METRICS_OBJ) $(APP_OBJ) $(TEST_UTIL_OBJ)) $(TESTS:=.d) \
         $(BUILD)/experiments/main.d
