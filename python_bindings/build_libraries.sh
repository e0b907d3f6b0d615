#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# build_libraries.sh FOLDER : builds the libraries that shlight links with from their sources and installs them there.
#
# Wheels link with these: Embree has the instruction sets and geometries that shlight uses, and is a part of the module.
# It needs git, CMake and a C++ compiler.
set -euo pipefail
folder=$(realpath -m "$1")
sources=$(mktemp -d)
trap 'rm -rf "$sources"' EXIT

# install_library REPOSITORY TAG OPTION...
install_library() {
    local source=$sources/$1 name=$1@$2
    [[ ! -e $folder/stamps/${name//\//-} ]] || return 0
    echo "building $name"
    git clone -q --depth 1 -c advice.detachedHead=false --branch "$2" "https://github.com/$1" "$source"
    cmake -S "$source" -B "$source/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$folder" \
        -DCMAKE_PREFIX_PATH="$folder" -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_POSITION_INDEPENDENT_CODE=ON "${@:3}" >/dev/null
    cmake --build "$source/build" --parallel "$(nproc)" >"$sources/log" || { cat "$sources/log" && return 1; }
    cmake --install "$source/build" >/dev/null
    install -D /dev/null "$folder/stamps/${name//\//-}"
}

install_library uxlfoundation/oneTBB v2022.3.0 -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBBMALLOC_BUILD=OFF
install_library RenderKit/embree v4.4.0 -DEMBREE_STATIC_LIB=ON -DEMBREE_TUTORIALS=OFF -DEMBREE_ISPC_SUPPORT=OFF \
    -DEMBREE_MAX_ISA=NONE -DEMBREE_ISA_{SSE2,AVX512}=OFF -DEMBREE_ISA_{SSE42,AVX,AVX2}=ON -DEMBREE_RAY_MASK=ON \
    -DEMBREE_GEOMETRY_{QUAD,SUBDIVISION,USER,GRID,INSTANCE_ARRAY}=OFF
install_library google/highway 1.3.0 -DBUILD_TESTING=OFF -DHWY_ENABLE_{CONTRIB,EXAMPLES,TESTS}=OFF
install_library zeux/meshoptimizer v1.0
install_library g-truc/glm 1.0.2 -DGLM_BUILD_TESTS=OFF
