#!/bin/bash
# GDAL 3.6.2 reads the grids of text that GRASS writes (r.out.ascii) in degrees elsewhere, and as whole numbers although doubles
# were asked for.
#
# The guess: a driver called "GRASS ASCII Grid" reads what GRASS's own r.out.ascii writes in a location in degrees, and the open
# option DATATYPE=Float64, made for grids whose type is guessed wrong, holds for them as for ESRI's.
# What it does: of an edge such as 51:30:15N it takes the number before the first colon. Minutes, seconds and the hemisphere are
# lost, so that a grid of less than a degree has no size, and one west of Greenwich lies east of it. A line "type: int" wins over
# the option: 1.5 becomes 1. "null: *", which is what GRASS writes by default, makes 0 the value for missing data, so that ground
# at 0 m is missing too. No warning is printed.
# To be right all the same: read the header's edges and its word for null yourself, and refuse fractions under "type: int".
#
# Fetches Debian 12's packages with all that they need (150 MB) into a temporary folder, installs nothing, and fails if any of
# this changes.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
chmod 755 .
mkdir -p archives/partial tree
: >status # as if nothing were installed, so that all is fetched
apt-get install -y -q --download-only --no-install-recommends -o Dir::State::status="$work/status" \
  -o Dir::Cache::archives="$work/archives" gdal-bin=3.6.2+dfsg-1+b2 >log 2>&1 ||
  { tail -n 20 log >&2; exit 1; }
for package in archives/*.deb; do dpkg-deb -x "$package" tree; done
rm -r archives

libraries=$(find tree/lib tree/usr/lib -name '*.so*' -printf '%h\n' | sort -u | sed "s|^|$work/|" | paste -sd:)
export GDAL_DATA="$work/tree/usr/share/gdal" PROJ_LIB="$work/tree/usr/share/proj"
inside() {
  "$work/tree/lib64/ld-linux-x86-64.so.2" --library-path "$libraries" "$work/tree/usr/bin/$1" "${@:2}"
}

cat >grid.asc <<'TXT'
north: 51:30:15N
south: 50:30:15N
east: 3:15:00W
west: 4:15:00W
rows: 2
cols: 2
null: *
type: int
1.5 0
* 4.5
TXT
{
  inside gdalinfo --version | sed 's/^GDAL \([0-9.]*\).*/SEEN GDAL \1/'
  inside gdalinfo -oo DATATYPE=Float64 grid.asc | grep -E '^(Origin|Pixel Size|Band)|NoData' | sed 's/^ */SEEN /; s/ Block.*Type=/ Type=/; s/, Color.*//'
  inside gdal_translate -q -of XYZ -oo DATATYPE=Float64 grid.asc /vsistdout/ | awk '{ print "SEEN height", $3 }'
} >seen 2>&1
cat >known <<'TXT'
SEEN GDAL 3.6.2
SEEN Origin = (4.000000000000000,51.000000000000000)
SEEN Pixel Size = (-0.500000000000000,-0.500000000000000)
SEEN Band 1 Type=Int32
SEEN NoData Value=0
SEEN height 1
SEEN height 0
SEEN height 0
SEEN height 4
TXT
cat seen
diff known seen >difference || { echo "Before, this was seen:"; cat known; exit 1; }
