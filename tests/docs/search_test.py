#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The search of the site, used as a reader does: search_test.py --browser <file> --driver <file> <html folder>."""

import argparse
import pathlib

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

# What is typed, and a page that has to be among those found.
EXPECTED = {
    "pendulum": "docs/guide/",
    "SFDAE_RANK_UNCLEAR": "docs/guide/status.html",
    "sfdae_make_consistent": "reference/c_sfdae.html",
    "dae_solver": "reference/fortran_sfdae_solver.html",
    "solve_ensemble": "reference/python.html",
}


def results(browser, site, word):
    """Pages that a search for a word, typed into the field of the first page, finds."""
    browser.get((site / "index.html").as_uri())
    field = browser.find_element(By.NAME, "q")
    field.send_keys(word)
    field.submit()
    wait = WebDriverWait(browser, 120)
    ended = ("finished", "did not match")
    wait.until(lambda page: any(words in page.find_element(By.ID, "search-results").text for words in ended))
    links = browser.find_elements(By.CSS_SELECTOR, "#search-results li a")
    return [link.get_attribute("href").split("?")[0].split("#")[0] for link in links]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--browser", required=True)
    parser.add_argument("--driver", required=True)
    parser.add_argument("site", type=pathlib.Path)
    options = parser.parse_args()
    settings = webdriver.ChromeOptions()
    settings.binary_location = options.browser
    # Wide: the field is hidden in narrow windows.
    for flag in ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--window-size=1600,1000"):
        settings.add_argument(flag)
    site = options.site.resolve()
    browser = webdriver.Chrome(service=Service(options.driver), options=settings)
    try:
        for word, page in EXPECTED.items():
            found = results(browser, site, word)
            assert any((site / page).as_uri() in link for link in found), f"{word}: {page} is not among {found}"
            print(f"{word}: {len(found)} pages")
        found = results(browser, site, "nosuchwordanywhere")
        assert not found, found
    finally:
        browser.quit()


if __name__ == "__main__":
    main()
