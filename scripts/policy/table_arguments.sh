# Sourced by the tables of policies, whose arguments are FOLDER [SEED...]: goes to the checkout, makes the folder and leaves
# `folder`, `root` (both whole paths) and the seeds of trainings as arguments, 1 without any. refuse TEXT: ends with the reason.
cd "$(dirname "$0")/../.."
table="$(basename "$0" .sh)"
refuse() {
  echo "$table: $1" >&2
  exit 2
}
case ${1:--} in
  -*) refuse "name a folder and, where you like, seeds of trainings, such as out/${table%_table} 1 2 3" ;;
esac
mkdir -p "$1"
folder="$(realpath "$1")" root="$PWD"
shift
[ $# -gt 0 ] || set -- 1
for seed in "$@"; do
  expr "$seed" : '[0-9][0-9]*$' >/dev/null || refuse "the seed $seed is no whole number"
done
