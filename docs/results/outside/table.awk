# Stated against found: awk -f table.awk predicted.csv measured.csv. The band of 90 % is 1.645 standard deviations
# to each side. With -v svg=1 a picture: distances from the prediction in half-widths of the band.
BEGIN { FS = ";" }
FNR == 1 { next }
NR == FNR { quantity[$1] = $2; unit[$1] = $3; stated[$1] = $4; band[$1] = 1.645 * $5; next }
{
    found = $2
    distance = (found - stated[$1]) / band[$1]
    inside = distance <= 1 && distance >= -1
    count += inside
    rows++
    mark = inside ? "" : "outside"
    if (svg) {
        y = 14 * rows + 20
        shown = distance > 3 ? 3 : distance < -3 ? -3 : distance
        lines = lines sprintf("<text x=\"300\" y=\"%d\" text-anchor=\"end\">%s</text><circle cx=\"%.1f\" cy=\"%d\" r=\"4\" fill=\"%s\"/>\n", y + 4, quantity[$1], 430 + 40 * shown, y, inside ? "#2a6f97" : "#c1440e")
    } else {
        table = table sprintf("%-52s %9s +- %-8.4g %9s %-7s %s\n", quantity[$1], stated[$1], band[$1], found, unit[$1], mark)
    }
}
END {
    if (svg) {
        printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 580 %d\" font-family=\"sans-serif\" font-size=\"10\">\n<rect width=\"580\" height=\"%d\" fill=\"white\"/>\n", 14 * rows + 50, 14 * rows + 50
        printf "<rect x=\"390\" y=\"24\" width=\"80\" height=\"%d\" fill=\"#dbe9f0\"/><text x=\"430\" y=\"16\" text-anchor=\"middle\">band of 90 %%</text>\n", 14 * rows + 6
        printf "%s<text x=\"430\" y=\"%d\" text-anchor=\"middle\">found, from the prediction; beyond three half-widths at the edge</text>\n</svg>\n", lines, 14 * rows + 44
        exit
    }
    printf "%-52s %21s %9s\n%s\n%d of %d inside\n", "", "stated", "found", table, count, rows
}
