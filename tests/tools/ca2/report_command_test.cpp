/// @file The report in a real browser.
#include <cstdlib>

#include "core/io/files.h"
#include "tests/tools/ca2/small_session.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

class ReportInABrowser : public SmallSession {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no chromium";
    SmallSession::SetUp();
    ASSERT_EQ(solve().status, 0);
    const Outcome run = run_ca2({"report", session});
    ASSERT_EQ(run.status, 0) << run.errors;
  }

  /// Runs chromium on a page; `file` is where its standard output goes.
  static int browse(const fs::path& page, const std::string& options, const fs::path& file) {
    return std::system(("timeout 120 chromium --headless=new --no-sandbox --disable-gpu --hide-scrollbars " +
                        options + " 'file://" + page.string() + "' >" + file.string() + " 2>/dev/null")
                           .c_str());
  }

  fs::path page() const { return session / "report" / "index.html"; }
};

/// Every picture loads, nothing is wider than the window, the switch switches.
TEST_F(ReportInABrowser, FitsAPhoneAndSwitches) {
  const std::string probe = R"(<script>addEventListener('load', () => {
const images = [...document.images]; images.forEach(i => i.loading = 'eager');
setTimeout(() => {
  const shown = name => [...document.querySelectorAll('.views .' + name)].filter(e => getComputedStyle(e).display != 'none').length;
  const before = shown('range') + ' ' + shown('residual');
  document.querySelector('label[for=residuals]').click();
  document.title = ['probe', document.documentElement.scrollWidth <= innerWidth, images.length,
                    images.every(i => i.complete && i.naturalWidth > 0), before,
                    shown('range') + ' ' + shown('residual')].join(',');
}, 3000);});</script>)";
  const fs::path probed = folder / "probed.html";
  write_bytes(probed, bytes_of(page()) + probe);
  for (const char* size : {"390,800", "1280,900"}) {
    const fs::path dom = folder / "dom.html";
    ASSERT_EQ(
        browse(probed, "--virtual-time-budget=20000 --window-size=" + std::string(size) + " --dump-dom", dom),
        0);
    const std::string text = bytes_of(dom);
    const std::size_t at = text.find("<title>");
    ASSERT_NE(at, std::string::npos);
    // Eight views with two pictures each, and the cloud.
    EXPECT_EQ(text.substr(at + 7, text.find("</title>") - at - 7), "probe,true,17,true,8 0,0 8") << size;
  }
}

TEST_F(ReportInABrowser, IsSeenAndPrinted) {
  const fs::path shot = folder / "shot.png", pdf = folder / "page.pdf";
  ASSERT_EQ(browse(page(), "--window-size=390,1400 --screenshot=" + shot.string(), folder / "log"), 0);
  const auto image = read_png(shot);
  ASSERT_TRUE(image) << image.error().text();
  std::size_t ink = 0;
  for (const std::uint8_t value : image->bytes) ink += value < 128;
  EXPECT_GT(ink, image->bytes.size() / 100) << "a blank page";
  ASSERT_EQ(browse(page(), "--no-pdf-header-footer --print-to-pdf=" + pdf.string(), folder / "log"), 0);
  EXPECT_GT(fs::file_size(pdf), 50000u);
}

}  // namespace
}  // namespace ca2
