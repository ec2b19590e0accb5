// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Html.h"

#include <gtest/gtest.h>

namespace explica {
namespace {

TEST(Html, WhatCouldOpenATagOrCloseAnAttributeIsReplacedOnce) {
  EXPECT_EQ(escapeHtml("<b title='a' id=\"c\">&amp;"),
            "&lt;b title=&#39;a&#39; id=&quot;c&quot;&gt;&amp;amp;");
  EXPECT_EQ(escapeHtml("gr\u00f6\u00dfer"), "gr\u00f6\u00dfer");
}

}  // namespace
}  // namespace explica
