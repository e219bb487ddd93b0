#!/usr/bin/env bash
# Draws the field guide's pictures: tools/doc-pictures.sh DIRECTORY (docs/images). A test compares the result with what is
# there. What a camera sees is projected, not sketched: a pinhole of 60 degrees, a board of 8 x 5 squares of 40 mm.
set -euo pipefail
directory=${1:?usage: tools/doc-pictures.sh DIRECTORY}
mkdir -p "$directory"

# frames FILE COLUMNS: reads "caption|good or bad|x|y|z|tip|turn|roll" (m in the camera's frame, degrees) and draws a
# camera's picture for each.
frames() {
  awk -F'|' -v columns="$2" '
    function rad(a) { return a * atan2(0, -1) / 180 }
    # A point of the board (m) in its picture (px of the drawing).
    function project(u, v,   x, y, z, t) {
      t = u * cr - v * sr; v = u * sr + v * cr; u = t          # roll about the normal
      x = u * cy; z = u * sy                                   # turn about the vertical
      y = v * cp - z * sp; z = v * sp + z * cp                 # tip about the horizontal
      z += Z
      px = ox + width / 2 + focal * (x + X) / z; py = oy + height / 2 + focal * (y + Y) / z
    }
    function quad(u0, v0, u1, v1, style,   s) {
      project(u0, v0); s = sprintf("%.1f,%.1f", px, py); project(u1, v0); s = s sprintf(" %.1f,%.1f", px, py)
      project(u1, v1); s = s sprintf(" %.1f,%.1f", px, py); project(u0, v1); s = s sprintf(" %.1f,%.1f", px, py)
      return "<polygon points=\"" s "\" " style "/>\n"
    }
    BEGIN { width = 176; height = 132; focal = width / 2 / (sin(rad(30)) / cos(rad(30))); gap = 12; foot = 30 }
    {
      ox = gap + (n % columns) * (width + gap); oy = gap + int(n / columns) * (height + foot); n++
      X = $3; Y = $4; Z = $5
      sp = sin(rad($6)); cp = cos(rad($6)); sy = sin(rad($7)); cy = cos(rad($7)); sr = sin(rad($8)); cr = cos(rad($8))
      body = body sprintf("<clipPath id=\"c%d\"><rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\"/></clipPath>\n", n, ox, oy, width, height)
      body = body sprintf("<g clip-path=\"url(#c%d)\"><rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#dfe5ea\"/>\n", n, ox, oy, width, height)
      body = body quad(-0.21, -0.1485, 0.21, 0.1485, "fill=\"#fff\" stroke=\"#888\"")
      for (i = 0; i < 8; i++) for (j = 0; j < 5; j++) if ((i + j) % 2 == 0)
        body = body quad(-0.16 + 0.04 * i, -0.1 + 0.04 * j, -0.12 + 0.04 * i, -0.06 + 0.04 * j, "")
      body = body "</g>\n"
      good = $2 == "good"
      body = body sprintf("<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n", ox, oy, width, height, good ? "#1a7f37" : "#c02020")
      body = body sprintf("<text x=\"%d\" y=\"%d\">%s %s</text>\n", ox, oy + height + 16, good ? "&#10003;" : "&#10007;", $1)
    }
    END {
      w = gap + columns * (width + gap); h = gap + int((n + columns - 1) / columns) * (height + foot)
      printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" font-family=\"sans-serif\" font-size=\"12\">\n", w, h, w
      printf "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n%s</svg>\n", w, h, body
    }' >"$1"
}

frames "$directory/poses.svg" 4 <<'END'
top edge away|good|0|0|0.75|-35|0|4
top edge near|good|-0.05|0.02|0.9|35|0|-6
left edge away|good|0.06|0|0.8|0|-38|5
right edge away|good|-0.06|-0.02|1.0|0|38|-4
in a corner, turned|good|-0.45|-0.27|1.3|20|-25|20
in the other corner|good|0.48|0.28|1.35|-25|20|-15
far, and low|good|0.15|0.45|1.9|-30|25|8
far, and high|good|-0.4|-0.5|2.0|30|-20|-10
END
frames "$directory/mistakes.svg" 4 <<'END'
always facing the camera|bad|0|0|0.8|0|0|0
the same again, nearer|bad|0.03|0|0.7|2|-2|1
cut off (a ChArUco may be)|bad|-0.42|0.05|0.75|10|-20|5
too far: few rings|bad|0.2|0.1|4.5|20|20|0
END

cat >"$directory/place.svg" <<'END'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 560 300" width="560" font-family="sans-serif" font-size="13">
<rect width="560" height="300" fill="#fff"/>
<text x="14" y="24" font-weight="bold">From above</text>
<polygon points="60,150 330,30 330,270" fill="#4a7ebb" fill-opacity=".15"/>
<circle cx="60" cy="182" r="150" fill="none" stroke="#b35900" stroke-dasharray="3 5"/>
<circle cx="60" cy="182" r="210" fill="none" stroke="#b35900" stroke-dasharray="3 5"/>
<rect x="40" y="138" width="22" height="22" fill="#4a7ebb"/><text x="14" y="130">camera</text>
<circle cx="60" cy="182" r="12" fill="#b35900"/><text x="14" y="214">LiDAR</text>
<line x1="230" y1="118" x2="262" y2="182" stroke="#111" stroke-width="6"/>
<text x="206" y="104">board, tilted</text>
<circle cx="305" cy="150" r="17" fill="#999"/><line x1="291" y1="160" x2="254" y2="166" stroke="#999" stroke-width="6"/><line x1="290" y1="142" x2="243" y2="141" stroke="#999" stroke-width="6"/>
<text x="326" y="148">you: arms out, nothing of</text><text x="326" y="164">the board's size behind it</text>
<line x1="510" y1="20" x2="510" y2="280" stroke="#555" stroke-width="8"/><text x="398" y="260">a wall: at least</text><text x="398" y="276">1 m behind it</text>
<line x1="72" y1="232" x2="250" y2="232" stroke="#111"/><text x="112" y="250">1.5 to 4 m</text>
</svg>
END

cat >"$directory/direction.svg" <<'END'
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 560 250" width="560" font-family="sans-serif" font-size="13">
<rect width="560" height="250" fill="#fff"/>
<defs><marker id="a" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto"><path d="M0,0L8,4L0,8z"/></marker></defs>
<g stroke="#111" stroke-width="2" marker-end="url(#a)">
<line x1="90" y1="150" x2="150" y2="150" stroke="#c02020"/><line x1="90" y1="150" x2="90" y2="210" stroke="#1a7f37"/><line x1="90" y1="150" x2="128" y2="118" stroke="#2050c0"/>
<line x1="330" y1="170" x2="366" y2="140" stroke="#c02020"/><line x1="330" y1="170" x2="276" y2="158" stroke="#1a7f37"/><line x1="330" y1="170" x2="330" y2="108" stroke="#2050c0"/>
</g>
<text x="152" y="166">x right</text><text x="46" y="222">y down</text><text x="112" y="110">z forward</text><text x="20" y="246" font-weight="bold">camera (optical axes): the parent</text>
<text x="370" y="140">x</text><text x="262" y="156">y</text><text x="336" y="106">z up</text><text x="300" y="246" font-weight="bold">LiDAR: the child</text>
<circle cx="440" cy="60" r="5"/><text x="450" y="56">a point p</text>
<g fill="none" stroke="#777" stroke-dasharray="5 4"><line x1="90" y1="150" x2="436" y2="61" marker-end="url(#a)"/><line x1="330" y1="170" x2="437" y2="65" marker-end="url(#a)"/></g>
<text x="196" y="96" fill="#555">p_camera</text><text x="396" y="124" fill="#555">p_lidar</text>
<text x="120" y="28" font-size="15">p_camera = T_camera_lidar  p_lidar</text>
<path d="M112,160 C180,205 250,205 318,176" fill="none" stroke="#b35900" stroke-width="2" marker-end="url(#a)"/>
<text x="150" y="222" fill="#b35900">T_camera_lidar: the pose of the LiDAR in the camera</text>
</svg>
END
