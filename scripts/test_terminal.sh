#!/bin/bash
# Watches `phyvisgen generate` in a terminal of 80 columns that is made 50, 110 and 80 wide while it runs: at every look
# there is at most one line of the set and one of the episode, both within the terminal, and at the end one of the set.
# Argument: where the looks are kept (else they are removed).
set -euo pipefail
cd "$(dirname "$0")/.."
command -v tmux >/dev/null || scripts/apt_install.sh tmux
folder=$(mktemp -d)
looks="${1:-$folder/looks}"
mkdir -p "$looks"
server=pvg_terminal_$$
cleanup() {
  tmux -L "$server" kill-server 2>/dev/null || true
  rm -rf "$folder"
}
trap cleanup EXIT

tmux -L "$server" -f /dev/null new-session -d -x 80 -y 24 "bash --norc"
tmux -L "$server" send-keys "PS1='> '; clear; build/bin/phyvisgen generate tests/pipeline/small_task/push_beaker.yaml \
-n 3 --seed 3 --samples 64 -o $folder/set; touch $folder/done" Enter
sleep 1 # the command's own lines are gone

look=0 with_bars=0 widths=(50 110 80)
while [ ! -e "$folder/done" ]; do
  sleep 0.4
  look=$((look + 1))
  # a new width every eighth look
  [ $((look % 8)) != 0 ] || tmux -L "$server" resize-window -x "${widths[look / 8 % 3]}" -y 24
  pane=$looks/$(printf %04d $look)
  tmux -L "$server" capture-pane -p >"$pane"
  for line in set episode; do
    n=$(grep -c "^$line " "$pane" || true)
    [ "$n" -le 1 ] || { echo "test_terminal: $n lines of the $line at once:" >&2; cat "$pane" >&2; exit 1; }
  done
  if grep -q '^set  *\[.*episodes' "$pane" && grep -q '^episode.*\[.*frames' "$pane"; then with_bars=$((with_bars + 1)); fi
  [ $look -lt 1500 ] || { echo "test_terminal: it does not end" >&2; exit 1; }
done
sleep 0.5
tmux -L "$server" capture-pane -p >"$looks/end"
if [ "$with_bars" -lt 3 ] || [ "$(grep -c '^set  *\[*.*3/3 episodes' "$looks/end")" != 1 ] || grep -q '^episode ' "$looks/end"; then
  echo "test_terminal: $with_bars of $look looks show both bars; at the end:" >&2
  cat "$looks/end" >&2
  exit 1
fi
echo "test_terminal: $look looks at 50, 80 and 110 columns, $with_bars with both bars: one line each, in place"
