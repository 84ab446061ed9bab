#!/bin/sh
# Stands in for `bilux` while the manual is tested: the same program, with smaller pictures and fewer samples.
set -eu
least() { [ "$1" -le "$2" ] && echo "$1" || echo "$2"; }
command=${1-}

before=
for argument do
    shift
    case $command$before in
        render--size) argument=48x32 ;;
        render--spp) argument=$(least "$argument" 4) ;;
        render--time-limit) argument=0.05 ;;
        render--noise) argument=50% ;;
        render--turntable) argument=$(least "$argument" 3) ;;
        # A 64th of the samples: 64..128 becomes 1..2.
        render--samples) argument=$((${argument%..*} / 64))..$(((${argument#*..} + 63) / 64)) ;;
    esac
    set -- "$@" "$argument"
    before=$argument
done

case " $* " in
    " render "*" --size "*) ;;
    " render "*) set -- "$@" --size 48x32 ;;
esac
case " $* " in
    " render "*" --spp "* | " render "*" --noise "* | " render "*" --time-limit "* | " render "*" --samples "*) ;;
    " render "*" --fast "*) set -- "$@" --set time_limit=0.05 ;;
    " render "*) set -- "$@" --time-limit 0.05 ;;
esac
# A server runs until somebody ends it: here as soon as it has printed its address, or has ended by itself.
case "$*" in
    *--help*) ;;
    "serve "*)
        address=$(mktemp)
        "$BILUX" "$@" --port 0 >"$address" &
        while [ ! -s "$address" ] && kill -0 $! 2>/dev/null; do sleep 0.1; done
        kill -TERM $! 2>/dev/null || true
        rm "$address"
        wait $!
        exit
        ;;
esac
exec "$BILUX" "$@"
