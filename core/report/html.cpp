#include "core/report/html.h"

#include "core/io/base64.h"

namespace ca2 {

std::string escaped(const std::string& raw) {
  std::string out;
  for (const char c : raw) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string data_uri(const std::string& type, const std::string& bytes) {
  return "data:" + type + ";base64," + to_base64(bytes);
}

const char* report_style() {
  return R"(<style>
:root{color-scheme:light dark;--line:#8884;--bar:#4a7ebb;--good:#1a7f37;--weak:#b35900;--refused:#c02020}
body{font:16px/1.5 system-ui,sans-serif;max-width:75rem;margin:1.5rem auto;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.2rem;margin-top:2.2rem}h3{font-size:1rem;margin:1.2rem 0 .3rem}
.scroll{overflow-x:auto}table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;white-space:nowrap;border-bottom:1px solid var(--line);text-align:right}
th:first-child,td:first-child,td.words{text-align:left}td.reason{text-align:left;white-space:normal;min-width:14rem}
.verdict{font-size:1.25rem;font-weight:600}.good{color:var(--good)}.weak{color:var(--weak)}.refused,.missing{color:var(--refused)}
.bar{display:inline-block;height:.7rem;background:var(--bar);vertical-align:middle}
img,svg{max-width:100%;height:auto;display:block}figure{margin:.8rem 0;min-width:0}figure img{width:100%}figcaption{font-size:.85rem}
.plots,.views{display:grid;gap:1rem;grid-template-columns:repeat(auto-fit,minmax(min(22rem,100%),1fr))}
.scale{display:inline-block;width:5rem;height:.7rem;vertical-align:middle;background:linear-gradient(90deg,red,yellow,lime,cyan,blue)}
.scale.signed{background:linear-gradient(90deg,#2166ff,#fff,#e02020)}
label{margin-right:1rem;cursor:pointer}.residual{display:none}
#residuals:checked~.views .residual{display:block}#residuals:checked~.views .range{display:none}
svg text{fill:currentColor;font:12px system-ui,sans-serif}svg .axis{stroke:currentColor;stroke-opacity:.5;fill:none}
code,pre{font-size:.85rem;overflow-wrap:anywhere}details summary{cursor:pointer}
@media print{body{max-width:none;font-size:11pt;margin:0}figure,table,svg{break-inside:avoid}h2,h3{break-after:avoid}
.views{grid-template-columns:1fr 1fr}label,input{display:none}.scroll{overflow:visible}th,td{padding:.1rem .3rem;font-size:9pt;white-space:normal}}
</style>)";
}

}  // namespace ca2
