#!/bin/sh
# check_pdf_a.sh FILE: holds a PDF against PDF/A-1b with Apache PDFBox's Preflight, of Debian's libpdfbox2-java.
set -eu
path=
for jar in preflight pdfbox2 xmpbox fontbox2 commons-logging javax.activation jaxb-api; do
  path=$path/usr/share/java/$jar.jar:
done
exec java -cp "$path" org.apache.pdfbox.preflight.Validator_A1b "$1"
