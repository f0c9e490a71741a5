#!/bin/sh
# What the machine code of the kernels takes, read from what the compilers left behind, and compared with the table.
#   machine_code.sh list FOLDER TARGET               rows: kernel,target,registers,private,spills
#   machine_code.sh check FOLDER TARGET TABLE        fails where a kernel takes more than its row, has none, or is gone
#   machine_code.sh complete FILE.ptx                fails where a function is called that is not there
#   machine_code.sh inputs                           checksum of the kernels, their flags and the compilers' versions
#   machine_code.sh ocloc OCLOC DEVICE KERNELS NAME RESULT    compiles KERNELS/NAME; what ocloc says goes to RESULT.log
# registers: of one work-item (Intel: of a thread); private: bytes of memory of one work-item; spills: registers kept
# there. A number that a compiler does not tell is a dash.
set -eu

# what was compiled, each file's text; FOLDER/files names them, so that code of a file that is gone does not count
texts() { # FOLDER TARGET SUFFIX
  while read -r name; do
    if [ -e "$1/$2/$name$3" ]; then cat "$1/$2/$name$3"; fi
  done <"$1/files"
}

list_amd() { # vector and scalar registers spilled are added
  texts "$1" "$2" .s | awk -v target="$2" '
    /^    \.name:/ { name = $2 }
    /^    \.private_segment_fixed_size:/ { bytes = $2 }
    /^    \.sgpr_spill_count:/ { spills = $2 }
    /^    \.vgpr_count:/ { registers = $2 }
    /^    \.vgpr_spill_count:/ { print name "," target "," registers "," bytes "," spills + $2 }'
}

list_ptx() { # registers are not yet shared out
  texts "$1" "$2" .ptx | awk -v target="$2" '
    function show() { if (name != "") print name "," target ",-," bytes ",-"; name = "" }
    /\.entry / { show(); name = $0; sub(/.*\.entry /, "", name); sub(/\(.*/, "", name); bytes = 0 }
    /\.local .*__local_depot/ { bytes = $0; sub(/.*\[/, "", bytes); sub(/\].*/, "", bytes) }
    END { show() }'
}

list_ptxas() {
  texts "$1" "$2" .log | awk -v target="$2" -F "'" '
    /Compiling entry function/ { name = $2 }
    /bytes stack frame/ { split($0, n, /[ ,]+/); for (i in n) if (n[i] == "stack") bytes = n[i - 2]; spills = 0
                          if (match($0, /[0-9]+ bytes spill stores/)) spills = int(substr($0, RSTART) / 4) }
    /Used [0-9]+ registers/ { match($0, /Used [0-9]+/); print name "," target "," substr($0, RSTART + 5, RLENGTH - 5) "," bytes "," spills }'
}

list_intel() { # ocloc names a kernel only where it spills
  texts "$1" "$2" .log | awk -v target="$2" '
    /^kernels:/ { for (i = 2; i <= NF; ++i) spills[$i] += 0 }
    /compiled SIMD.* spilled around/ { for (i = 1; i < NF; ++i) if ($i == "kernel") spills[$(i + 1)] = $NF }
    END { for (name in spills) print name "," target ",-,-," spills[name] }'
}

list() {
  case "$2" in
    gfx*) list_amd "$1" "$2" ;;
    nvptx*) list_ptx "$1" "$2" ;;
    sm_*) list_ptxas "$1" "$2" ;;
    *) list_intel "$1" "$2" ;;
  esac | LC_ALL=C sort
}

check() {
  list "$1" "$2" | awk -F , -v target="$2" -v table="$3" '
    # registers are shared out in eights
    function more(now, known, unit) { return now != "-" && known != "-" && int((now + unit - 1) / unit) > int((known + unit - 1) / unit) }
    function complain(name, text) { print "machine code: " name " on " target ": " text; bad = 1 }
    BEGIN { while ((getline line < table) > 0) if (split(line, f, ",") == 5 && f[2] == target) {
              registers[f[1]] = f[3]; bytes[f[1]] = f[4]; spills[f[1]] = f[5] } }
    !($1 in registers) { complain($1, "not in the table; scripts/test_vendors.sh --write renews it"); next }
    { seen[$1] = 1; ++n
      if (more($3, registers[$1], 8)) complain($1, $3 " registers, " registers[$1] " in the table")
      if (more($4, bytes[$1], 1)) complain($1, $4 " private bytes, " bytes[$1] " in the table")
      if (more($5, spills[$1], 1)) complain($1, $5 " spills, " spills[$1] " in the table") }
    END { for (name in registers) if (!(name in seen)) complain(name, "in the table, but no such kernel was compiled")
          if (!n) { print "machine code: nothing for " target " is in the table"; bad = 1 }
          if (!bad) print "machine code: " n " kernels on " target " take no more than the table says"
          exit bad }'
}

case "$1" in
  list) list "$2" "$3" ;;
  check) check "$2" "$3" "$4" ;;
  complete)
    if missing=$(grep -A 1 '\.extern \.func' "$2"); then
      rm -f "$2"
      printf '%s\n' "machine code: $2 calls what is not there:" "$missing" >&2
      exit 1
    fi ;;
  inputs)
    cd "$(dirname "$0")/.."
    { find kernels -name '*.cl' -o -name '*.h' -o -name CMakeLists.txt | LC_ALL=C sort | xargs sha256sum
      sha256sum scripts/machine_code.sh
      # without Debian's list of packages no table is known to be of these compilers
      dpkg-query -W clang-19 libclc-19 lld-19 intel-opencl-icd libigc1 2>&1 || date +%s%N; } | sha256sum | cut -c 1-32 ;;
  ocloc)
    ocloc=$2 device=$3 kernels=$4 name=$5 result=$6
    # ocloc writes no list of what it read
    echo "$result.log: $(find "$kernels" -name '*.cl' -o -name '*.h' | tr '\n' ' ')" >"$result.log.d"
    log=$("$ocloc" compile -file "$kernels/$name" -device "$device" -output "$(basename "$result")" \
      -out_dir "$(dirname "$result")" -options "-cl-std=CL1.2 -DPVG_SYNTAX_CHECK -I$kernels" 2>&1) || {
      printf '%s\n' "$log" >&2
      exit 1
    }
    # the names of the kernels are in the binary's tables
    { printf '%s\n' "$log"; echo "kernels: $("${0%/*}/kernel_names.sh" "$kernels/$name" | tr '\n' ' ')"; } >"$result.log" ;;
  *) sed -n '2,9p' "$0" >&2; exit 2 ;;
esac
