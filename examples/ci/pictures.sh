#!/usr/bin/env bash
# A CI check that fails when a picture drifts from its reference.
#
#   pictures.sh REFERENCES CANDIDATES [OPTIONS OF nullray compare]
#
# Compares every picture of the first folder with the one of the same name in the second, and writes a report beside each
# candidate. Fails where a limit is exceeded, and where compare says what is wrong (a diagnosis), whatever the limits.
# Without options the limits are those below; .png and .npy hold light alone, and the others all channels (--aovs all). $NULLRAY is the program; by
# default it is found in the path.
set -euo pipefail
references=${1:?a folder of references} candidates=${2:?a folder of candidates}
shift 2
for folder in "$references" "$candidates"; do
  [ -d "$folder" ] || { echo "$folder is not a folder" >&2; exit 2; }
done
light=(--tolerance relrmse=0.05)
surfaces=(--tolerance geometric.p99=0.1 --tolerance coverage=0.99 --tolerance time.p99=0.05 --tolerance w.p99=0.01 "${light[@]}")
# Channels of surfaces that no other limit is about; at edges of triangles a few pixels show the next one.
for axis in x y z; do surfaces+=(--tolerance "normal.$axis:p90=0.02"); done
for axis in x y z; do surfaces+=(--tolerance "direction.$axis:p90=0.001"); done
surfaces+=(--tolerance distance:p90=0.05 --tolerance object_event.ct:p90=0.05 --tolerance alpha:mae=0.01)
for axis in u v; do surfaces+=(--tolerance "uv.$axis:p90=0.01" --tolerance "barycentric.$axis:p90=0.05"); done

compared=0 failed=0
for reference in "$references"/*.exr "$references"/*.npz "$references"/*.npy "$references"/*.png; do
  [ -e "$reference" ] || continue
  candidate=$candidates/$(basename "$reference")
  compared=$((compared + 1))
  limits=("$@")
  if [ $# -eq 0 ]; then
    case $reference in
      *.png | *.npy) limits=("${light[@]}") ;;
      *) limits=("${surfaces[@]}") ;;
    esac
  fi
  echo "== $candidate"
  if [ ! -e "$candidate" ]; then
    echo "it is missing"
    failed=$((failed + 1))
  elif ! found=$("${NULLRAY:-nullray}" compare "$reference" "$candidate" --report "${candidate%.*}-report.html" "${limits[@]}"); then
    echo "$found"
    failed=$((failed + 1))
  else
    echo "$found"
    if grep -q '^diagnosis: ' <<<"$found"; then
      failed=$((failed + 1))
    fi
  fi
done
[ "$compared" -eq 1 ] && noun=picture || noun=pictures
echo "$compared $noun compared, $failed failed"
[ "$compared" -gt 0 ] || echo "$references holds no .exr, .npz, .npy or .png" >&2
[ "$compared" -gt 0 ] && [ "$failed" -eq 0 ]
