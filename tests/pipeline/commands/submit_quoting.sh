#!/bin/bash
# `submit --generate`: an option reaches generate on the cluster letter for letter, whatever signs it holds; a wrong one is
# named before anything is written. Arguments: the program, a task.
set -euo pipefail
program="$(realpath "$1")" task="$(realpath "$2")"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
cd "$root"
folder="$root/it's a \"set\" of \$HOME"
option='--device=it'\''s $(touch ran) `touch ran` "x" * \ ;touch ran'
"$program" submit "$task" -n 2 --shards 2 -o "$folder" "--generate=$option" --generate=--samples=8 >said

# the job as Slurm's shell runs it, with a program that writes its words instead
printf '#!/bin/bash\nprintf "%%s\\n" "$@" >"%s/words"\n' "$root" >stub
chmod +x stub
job=$(<"$folder/jobs/generate.sbatch")
[[ "$job" == *"'$program' generate"* ]] || { echo "submit_quoting: the job does not call $program" >&2; exit 1; }
printf '%s\n' "${job/"'$program'"/"'$root/stub'"}" >job
SLURM_ARRAY_TASK_ID=1 bash job >log 2>&1
for word in "$option" --samples=8 "$folder/shards/0001" "$task" 1/2; do
  grep -qxF -- "$word" words || { echo "submit_quoting: generate does not get the word $word but:" >&2; cat words >&2; exit 1; }
done
[ ! -e ran ] || { echo "submit_quoting: a shell ran what the option holds" >&2; exit 1; }

code=0
"$program" submit "$task" -n 2 -o other --generate=--samples=nan >said 2>&1 || code=$?
if [ $code != 2 ] || ! grep -q -- '--samples' said || [ -e other ]; then
  echo "submit_quoting: a wrong option ended with code $code: $(cat said)" >&2
  exit 1
fi
